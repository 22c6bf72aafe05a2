// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { formatAddress, linkPath, NOWHERE, parseAddress, roundedPose } from '../../page/address.js';

const POSE = { position: [1.25, -3e-7, 123456.789], target: [0, 1e20, -0.333333333333] } as const;

describe('a link', () => {
  it.each(['horse.hier', 'models/sub/a b.hier', 'ä&#?%,/ü.hier', '', '漢字/🐎.hier'])('to %s comes back', (path) => {
    const hash = formatAddress({ path, pose: POSE, choices: 'up=z' });
    expect(parseAddress(new URL(hash, 'http://a/').hash)?.path).toBe(linkPath(path));
    expect(decodeURIComponent(linkPath(path))).toBe(path);
    expect(parseAddress(hash)?.pose?.position).toEqual(POSE.position);
    expect(parseAddress(hash)?.choices).toBe('up=z');
  });

  it.each([
    ['models/a%20b.hier', 'models/a%20b.hier'],
    ['models/a b.hier', 'models/a%20b.hier'],
    ['%C3%A9,(1).hier', '%C3%A9%2C(1).hier'],
    ['100%25.hier', '100%25.hier'],
    ['100%.hier', '100%25.hier'],
    ['a%2Fb%26%3A.hier', 'a%2Fb%26%3A.hier'],
    ['https://other:8080/a%20b.hier', 'https://other:8080/a%20b.hier'],
  ])('to %s escapes it once', (path, escaped) => {
    expect(formatAddress({ path, ...NOWHERE })).toBe(`#${escaped}`);
    expect(formatAddress(parseAddress(`#${escaped}`)!)).toBe(`#${escaped}`);
  });

  it('keeps a rounded pose as it is', () => {
    const pose = roundedPose({ position: [1 / 3, Math.PI * 1e-9, -Math.E * 1e9], target: [0, 1e-300, 2 / 3] });
    expect(Math.abs(pose.position[0] * 3 - 1)).toBeLessThan(1e-11);
    expect(parseAddress(formatAddress({ path: 'x', pose, choices: '' }))!.pose).toEqual(pose);
  });

  it('may have no camera', () => {
    expect(parseAddress('#a/b.hier')).toEqual({ path: 'a/b.hier', ...NOWHERE });
    expect(formatAddress({ path: 'a/b.hier', ...NOWHERE })).toBe('#a/b.hier');
    expect(parseAddress('#a&up=z&light=flat')).toEqual({ path: 'a', pose: null, choices: 'up=z&light=flat' });
    expect(formatAddress({ path: 'a', pose: null, choices: 'up=z&light=flat' })).toBe('#a&up=z&light=flat');
  });

  it.each([[NaN, 0, 0], [Infinity, 0, 0], [1e300, 1, 0], [0, 0, 0]] as const)('has no camera at %s, %s, %s', (...position) => {
    expect(formatAddress({ path: 'a', pose: { position, target: [0, 0, 0] }, choices: 'up=z' })).toBe('#a&up=z');
  });

  it('names no model if it is empty or broken', () => {
    for (const hash of ['', '#', '#%E0%A4%A']) expect(parseAddress(hash)).toBeNull();
  });

  it.each(['1,2,3', '1,2,3,4,5,x', '1,2,3,4,5,', '1,2,3,4,5,1e999', '1e300,2,3,1e300,5,6', '1,2,3,1,2,3', '1,2,3,4,5,6,7', ''])(
    'drops the camera %s',
    (pose) => { expect(parseAddress(`#a&${pose}`)).toEqual({ path: 'a', ...NOWHERE }); },
  );
});
