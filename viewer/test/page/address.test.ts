import { describe, expect, it } from 'vitest';
import { formatAddress, parseAddress } from '../../page/address.js';

const POSE = { position: [1.25, -3e-7, 123456.789], target: [0, 1e20, -0.333333333333] } as const;

describe('a link', () => {
  it.each(['horse.hier', 'models/sub/a b.hier', 'ä&#?%,/ü.hier', '', '漢字/🐎.hier'])('to %s comes back', (path) => {
    const hash = formatAddress({ path, pose: POSE });
    expect(parseAddress(new URL(hash, 'http://a/').hash)?.path).toBe(path);
    expect(parseAddress(hash)?.pose?.position).toEqual(POSE.position);
  });

  it('keeps ten digits', () => {
    const back = parseAddress(formatAddress({ path: 'x', pose: POSE }))!.pose!;
    expect(Math.abs(back.target[2] / POSE.target[2] - 1)).toBeLessThan(1e-9);
  });

  it('may have no camera', () => {
    expect(parseAddress('#a/b.hier')).toEqual({ path: 'a/b.hier', pose: null });
    expect(formatAddress({ path: 'a/b.hier', pose: null })).toBe('#a/b.hier');
  });

  it('names no model if it is empty or broken', () => {
    for (const hash of ['', '#', '#%E0%A4%A']) expect(parseAddress(hash)).toBeNull();
  });

  it.each(['1,2,3', '1,2,3,4,5,x', '1,2,3,4,5,', '1,2,3,4,5,1e999', '1,2,3,1,2,3', '1,2,3,4,5,6,7', ''])(
    'drops the camera %s',
    (pose) => { expect(parseAddress(`#a&${pose}`)).toEqual({ path: 'a', pose: null }); },
  );
});
