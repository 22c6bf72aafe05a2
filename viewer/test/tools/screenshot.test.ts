// SPDX-License-Identifier: MIT
import { inflateSync } from 'node:zlib';
import { describe, expect, it } from 'vitest';
import { PngWriter } from '../../src/tools/png.js';
import { MOST_SIZE, partsOf, takePicture, type Part } from '../../src/tools/screenshot.js';

interface Picture {
  readonly width: number;
  readonly height: number;
  readonly pixels: Uint8Array;
}

/// RGBA with the filter "up" alone; checks nothing but the chunks' sums, with a table of its own.
async function decode(blob: Blob): Promise<Picture> {
  const bytes = Buffer.from(await blob.arrayBuffer());
  expect([...bytes.subarray(0, 8)]).toEqual([137, 80, 78, 71, 13, 10, 26, 10]);
  const packed: Buffer[] = [];
  let [width, height, last] = [0, 0, ''];
  for (let at = 8; at < bytes.length; ) {
    const length = bytes.readUInt32BE(at);
    last = bytes.toString('latin1', at + 4, at + 8);
    const content = bytes.subarray(at + 8, at + 8 + length);
    expect(bytes.readUInt32BE(at + 8 + length)).toBe(checksum(bytes.subarray(at + 4, at + 8 + length)));
    if (last === 'IHDR') [width, height] = [content.readUInt32BE(0), content.readUInt32BE(4)];
    if (last === 'IDAT') packed.push(content);
    at += 12 + length;
  }
  expect(last).toBe('IEND');
  const raw = inflateSync(Buffer.concat(packed));
  const pixels = new Uint8Array(4 * width * height);
  for (let row = 0; row < height; ++row) {
    expect(raw[row * (4 * width + 1)]).toBe(2);
    for (let i = 0; i < 4 * width; ++i)
      pixels[row * 4 * width + i] = raw[row * (4 * width + 1) + 1 + i] + (row > 0 ? pixels[(row - 1) * 4 * width + i] : 0);
  }
  return { width, height, pixels };
}

function checksum(bytes: Uint8Array): number {
  let rest = 0xffffffff;
  for (const byte of bytes) {
    rest ^= byte;
    for (let bit = 0; bit < 8; ++bit) rest = (rest >>> 1) ^ (rest & 1 ? 0xedb88320 : 0);
  }
  return (rest ^ 0xffffffff) >>> 0;
}

/// Each pixel tells where it is; as WebGL reads them, the lowest row first.
function painted(_: unknown, { x, y, width, height }: Part): Uint8Array {
  const pixels = new Uint8Array(4 * width * height);
  for (let row = 0; row < height; ++row)
    for (let column = 0; column < width; ++column)
      pixels.set([(x + column) & 255, (y + height - 1 - row) & 255, (x + column) >> 8, 255], 4 * (row * width + column));
  return pixels;
}

describe('a screenshot', () => {
  it.each([[1, 1], [700, 3], [300, 520], [513, 257]])('of %d x %d pixels has each pixel in its place, however it was drawn', async (width, height) => {
    const { pixels, ...size } = await decode(await takePicture({ width, height }, painted, null, { side: 256 }));
    expect(size).toEqual({ width, height });
    for (let i = 0; i < width * height; ++i)
      if (pixels[4 * i] !== (i % width & 255) || pixels[4 * i + 1] !== (Math.floor(i / width) & 255) || pixels[4 * i + 2] !== (i % width) >> 8) throw new Error(`pixel ${i}`);
  });

  it('is drawn in parts that cover it once', () => {
    const parts = partsOf({ width: 2500, height: 1024 }, 1024);
    expect(parts).toEqual([[{ x: 0, y: 0, width: 1024, height: 1024 }, { x: 1024, y: 0, width: 1024, height: 1024 }, { x: 2048, y: 0, width: 452, height: 1024 }]]);
  });

  it('has what is half there on its ground, or half transparent', async () => {
    const half = (): Uint8Array => Uint8Array.of(100, 50, 0, 128, 0, 0, 0, 0);
    expect([...(await decode(await takePicture({ width: 2, height: 1 }, half, [255, 255, 255]))).pixels]).toEqual([227, 177, 127, 255, 255, 255, 255, 255]);
    expect([...(await decode(await takePicture({ width: 2, height: 1 }, half, null))).pixels]).toEqual([199, 100, 0, 128, 0, 0, 0, 0]);
  });

  it.each([0, -1, 1.5, NaN, MOST_SIZE + 1])('of %d pixels is refused', async (side) => {
    await expect(takePicture({ width: side, height: 10 }, painted, null)).rejects.toThrow(RangeError);
  });

  it('with rows missing is no picture', async () => {
    const writer = new PngWriter(2, 2);
    await writer.write(new Uint8Array(8));
    await expect(writer.finish()).rejects.toThrow('1 rows of 2');
  });
});

describe('a picture for print', () => {
  it('tells how large it is', async () => {
    const bytes = Buffer.from(await (await takePicture({ width: 3, height: 2 }, painted, null, { dotsPerInch: 300 })).arrayBuffer());
    const at = bytes.indexOf('pHYs');
    expect([bytes.readUInt32BE(at + 4), bytes.readUInt32BE(at + 8), bytes[at + 12]]).toEqual([11811, 11811, 1]);
    expect(at).toBeLessThan(bytes.indexOf('IDAT'));
  });

  it('tells how far it is, and ends when it is told to', async () => {
    const told: string[] = [];
    const ending = new AbortController();
    const progress = (done: number, all: number): void => {
      told.push(`${done}/${all}`);
      if (done === 3) ending.abort(new Error('enough'));
    };
    await expect(takePicture({ width: 30, height: 30 }, painted, null, { side: 10, signal: ending.signal, progress })).rejects.toThrow('enough');
    expect(told).toEqual(['1/9', '2/9', '3/9']);
  });
});
