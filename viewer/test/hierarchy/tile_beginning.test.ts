// SPDX-License-Identifier: MIT
// Roots that can be drawn before their normal map has come.
import { gzipSync } from 'node:zlib';
import { describe, expect, it } from 'vitest';
import { TileBeginning } from '../../src/hierarchy/tile_beginning.js';
import { jpeg } from '../support/pictures.js';
import { packedTileBytes, tileBytes, type TileParts } from '../support/tile_bytes.js';

const MAP = { file: jpeg(64, 32), mimeType: 'image/jpeg', width: 64, height: 32 };
const BARE: TileParts = { own: 3, positions: [0, 0, 0, 1, 0, 0, 0, 1, 0], codes: [0, 0, 127, 0, 0, 127, 0, 0, 127], interior: [0, 1, 2] };
const MAPPED: TileParts = { ...BARE, tangents: [127, 0, 0, 127, 127, 0, 0, 127, 127, 0, 0, 127], texcoords: [0, 0, 1, 0, 0, 1], normalMap: MAP };

/// What is found in pieces of so many bytes, and how many of them were needed; null: nothing.
async function found(file: Uint8Array, piece: number): Promise<{ bytes: Uint8Array; taken: number } | null> {
  let result: { bytes: Uint8Array; taken: number } | null = null;
  let taken = 0;
  const beginning = new TileBeginning('root', (bytes) => { result = { bytes, taken }; });
  for (let at = 0; at < file.length && result === null; at += piece) {
    taken = Math.min(file.length, at + piece);
    beginning.take(file.subarray(at, taken));
    await new Promise((resolve) => setTimeout(resolve));
  }
  return result;
}

/// The map's bytes, and what lies behind them, are zeros.
function withoutMap(file: Uint8Array): Uint8Array {
  const padded = MAP.file.length + (-MAP.file.length & 3);
  return Uint8Array.from(file, (byte, i) => (i < file.length - padded ? byte : 0));
}

describe('TileBeginning', () => {
  it.each([13, 64, 1e6])('gives all but the map, in pieces of %d bytes', async (piece) => {
    for (const file of [tileBytes(MAPPED), await packedTileBytes(MAPPED)]) {
      const { bytes, taken } = (await found(file, piece))!;
      expect(bytes).toEqual(withoutMap(file));
      expect(taken).toBeLessThan(file.length - MAP.file.length + piece + 4);
    }
  });

  it('gives it out of gzip', async () => {
    const noise = Uint8Array.from({ length: 20_000 }, (_, i) => (i < MAP.file.length ? MAP.file[i] : (i * i * 2654435761) >>> 13));
    const file = tileBytes({ ...MAPPED, normalMap: { ...MAP, file: noise } });
    const packed = gzipSync(file);
    const { bytes, taken } = (await found(packed, 256))!;
    expect(bytes.subarray(0, 500)).toEqual(file.subarray(0, 500));
    expect(taken).toBeLessThan(packed.length / 4);
  });

  it('gives nothing of a tile without a map', async () => {
    expect(await found(tileBytes(BARE), 64)).toBeNull();
    expect(await found(tileBytes({ ...BARE, texcoords: MAPPED.texcoords, picture: MAP }), 64)).toBeNull();
  });

  it.each<[string, (file: Uint8Array<ArrayBuffer>) => Uint8Array]>([
    ['that ends before', (file) => file.subarray(0, 600)],
    ['that says to be endless', (file) => { new DataView(file.buffer).setUint32(8, 2 ** 31, true); return file; }],
    ['that says to be shorter', (file) => { new DataView(file.buffer).setUint32(8, 400, true); return file; }],
    ['whose JSON is none', (file) => file.fill(33, 20, 24)],
    ['that is no tile', () => new Uint8Array(1000).fill(7)],
    ['whose gzip is none', (file) => Uint8Array.of(0x1f, 0x8b, ...file)],
    ['whose map is not the last section', (file) => {
      const text = new TextDecoder('latin1').decode(file).replace(/"normalMap":(\d+)/, (_, number: string) => `"normalMap":${'0'.padEnd(number.length)}`);
      return Uint8Array.from(text, (letter) => letter.charCodeAt(0));
    }],
  ])('gives nothing of a file %s', async (_, change) => {
    expect(await found(change(tileBytes(MAPPED) as Uint8Array<ArrayBuffer>), 64)).toBeNull();
  });
});
