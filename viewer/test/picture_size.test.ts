// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { pictureSize } from '../src/hierarchy/picture_size.js';
import { jpeg, png, webp } from './support/pictures.js';
import { random } from './support/random.js';

const FILES: [string, string, Uint8Array, number, number][] = [
  ['a PNG', 'image/png', png(700, 3), 700, 3],
  ['a JPEG', 'image/jpeg', jpeg(8192, 300, 0xc0), 8192, 300],
  ['a progressive JPEG', 'image/jpeg', jpeg(1, 65535), 1, 65535],
  ['a WebP', 'image/webp', webp('VP8 ', 300, 16383), 300, 16383],
  ['a lossless WebP', 'image/webp', webp('VP8L', 16384, 1), 16384, 1],
  ['a WebP with alpha', 'image/webp', webp('VP8X', 70_000, 257), 70_000, 257],
];

describe('pictureSize', () => {
  it.each(FILES)('knows that of %s', (_, type, bytes, width, height) => {
    expect(pictureSize(bytes, type)).toEqual({ width, height });
  });

  it.each(FILES)('knows none where %s ends before it', (_, type, bytes) => {
    for (let end = 0; end < 24; ++end) expect(pictureSize(bytes.subarray(0, end), type)).toBeNull();
  });

  it('takes no type for another', () => {
    for (const [, type, bytes] of FILES)
      for (const other of ['image/png', 'image/jpeg', 'image/webp', 'image/gif', 'undefined'])
        if (other !== type) expect(pictureSize(bytes, other)).toBeNull();
  });

  it('reads no byte behind the end, whatever the bytes are', () => {
    const next = random(3);
    for (const [, type, bytes] of FILES)
      for (let round = 0; round < 500; ++round) {
        const hurt = bytes.slice(0, Math.floor(next() * (bytes.length + 1)));
        if (hurt.length > 0) hurt[Math.floor(next() * hurt.length)] = Math.floor(256 * next());
        expect(() => pictureSize(hurt, type)).not.toThrow();
      }
  });
});
