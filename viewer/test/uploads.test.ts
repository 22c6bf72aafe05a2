// SPDX-License-Identifier: MIT
// Pictures that go to the GPU before their tiles are drawn.
import { Texture } from 'three';
import { describe, expect, it } from 'vitest';
import { Uploads } from '../src/scene/uploads.js';

const LARGE = 896;
const SMALL = 64;

function texture(side: number): Texture {
  return new Texture({ width: side, height: side });
}

class Device {
  readonly uploaded: Texture[] = [];
  readonly initTexture = (one: Texture): void => { this.uploaded.push(one); };
}

describe('Uploads', () => {
  it('gives one large texture a frame, in the order in which they came', () => {
    const [uploads, device] = [new Uploads(), new Device()];
    const textures = [texture(LARGE), texture(LARGE), texture(LARGE)];
    uploads.add(1, textures.slice(0, 2));
    uploads.add(2, textures.slice(2));
    expect([uploads.step(device, true), uploads.awaits(1), uploads.awaits(2)]).toEqual([true, true, true]);
    expect([uploads.step(device, true), uploads.awaits(1), uploads.awaits(2)]).toEqual([true, false, true]);
    expect([uploads.step(device, true), uploads.awaits(1), uploads.awaits(2)]).toEqual([false, false, false]);
    expect(device.uploaded).toEqual(textures);
    expect(uploads.step(device, true)).toBe(false);
  });

  it('gives more of them while the camera rests', () => {
    const [uploads, device] = [new Uploads(), new Device()];
    uploads.add(1, [texture(LARGE), texture(LARGE), texture(LARGE)]);
    expect(uploads.step(device, false)).toBe(true);
    expect(device.uploaded).toHaveLength(2);
  });

  it('gives several small ones, and none of a tile that has gone', () => {
    const [uploads, device] = [new Uploads(), new Device()];
    const gone = texture(SMALL);
    uploads.add(1, Array.from({ length: 20 }, () => texture(SMALL)));
    uploads.add(2, [gone]);
    uploads.forget(2);
    expect(uploads.step(device, true)).toBe(false);
    expect(device.uploaded).toHaveLength(20);
    expect(device.uploaded).not.toContain(gone);
    expect(uploads.awaits(1)).toBe(false);
  });
});
