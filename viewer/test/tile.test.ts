// SPDX-License-Identifier: MIT
import { readFileSync, readdirSync } from 'node:fs';
import path from 'node:path';
import { gunzipSync } from 'node:zlib';
import { afterAll, describe, expect, it } from 'vitest';
import { isInsideOut } from '../src/hierarchy/closed.js';
import { HierarchyProblem } from '../src/hierarchy/problem.js';
import { readTile, type Tile } from '../src/hierarchy/tile.js';
import { windingNumber } from '../src/cut/winding.js';
import { hasProgram, Workshop } from './support/meshhier.js';
import { random } from './support/random.js';

function filesBelow(hierarchy: string): string[] {
  const tiles = path.join(hierarchy, 'tiles');
  return readdirSync(tiles, { recursive: true }).map((name) => path.join(tiles, String(name))).filter((name) => name.endsWith('.glb'));
}

function bytesOf(file: string): Uint8Array {
  const bytes = readFileSync(file);
  return new Uint8Array(bytes[0] === 0x1f ? gunzipSync(bytes) : bytes);
}

/// A glTF binary with another JSON.
function withJson(bytes: Uint8Array, change: (text: string) => string): Uint8Array {
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  const length = view.getUint32(12, true);
  const text = change(new TextDecoder().decode(bytes.subarray(20, 20 + length)).trimEnd());
  const json = new TextEncoder().encode(text.padEnd(Math.ceil(text.length / 4) * 4));
  const made = new Uint8Array(bytes.length - length + json.length);
  made.set(bytes.subarray(0, 20));
  made.set(json, 20);
  made.set(bytes.subarray(20 + length), 20 + json.length);
  const sizes = new DataView(made.buffer);
  sizes.setUint32(8, made.length, true);
  sizes.setUint32(12, json.length, true);
  return made;
}

function withCount(bytes: Uint8Array, key: string, count: number): Uint8Array {
  return withJson(bytes, (text) => text.replace(new RegExp(`"${key}":\\d+`), `"${key}":${count}`));
}

/// True of every tile, whatever its bytes are: else what is drawn of it would read outside of it.
function isSound({ own, ghosts, copyOf, splitOf, positions, indices, border, ghostStarts, interiorCount, normals }: Tile): boolean {
  const unsplit = own + ghosts + copyOf.length;
  const vertices = unsplit + splitOf.length;
  return positions.length === 3 * vertices && normals.length === 4 * vertices && positions.every(Number.isFinite) &&
    indices.length === 3 * interiorCount + border.length && indices.every((v) => v < vertices) && border.every((v) => v < vertices) &&
    ghostStarts.every((start) => start <= ghosts) && splitOf.every((v) => v < unsplit);
}

describe.skipIf(!hasProgram)('readTile', () => {
  const workshop = new Workshop();
  afterAll(() => {
    workshop.remove();
  });
  const config = (compression: string): object => ({ partition: { vertices: 200 }, storage: { compression } });

  it.each(['none', 'zlib', 'meshopt', 'meshopt_zlib'])('reads the same of tiles with compression %s', async (compression) => {
    const mesh = ['surface', '--triangles', '1500', '--colours'];
    const plain = workshop.build('plain', mesh, config('none'));
    const packed = workshop.build(compression, mesh, config(compression));
    for (const file of filesBelow(plain)) {
      const name = path.relative(plain, file);
      const [one, other] = [await readTile(bytesOf(file), name, null), await readTile(bytesOf(path.join(packed, name)), name, null)];
      expect(other.positions).toEqual(one.positions);
      expect(other.colours).toEqual(one.colours);
      expect(other.chains).toEqual(one.chains);
      expect(other.indices.length).toBe(one.indices.length);
      expect(isSound(one)).toBe(true);
    }
  });

  it.each(['none', 'meshopt'])('refuses damaged bytes, or is sound: %s', async (compression) => {
    const hierarchy = workshop.build(`hurt-${compression}`, ['surface', '--triangles', '800', '--colours'], config(compression));
    const next = random(5);
    let refused = 0;
    for (const file of filesBelow(hierarchy)) {
      const bytes = bytesOf(file);
      for (let round = 0; round < 150; ++round) {
        const hurt = round % 5 === 0 ? bytes.slice(0, Math.floor(next() * bytes.length)) : bytes.slice();
        for (let flips = 0; flips < 1 + round % 3; ++flips) hurt[Math.floor(next() * Math.min(hurt.length, round % 2 === 0 ? 4000 : Infinity))] ^= 1 << Math.floor(8 * next());
        try {
          expect(isSound(await readTile(hurt, 'hurt.glb', null))).toBe(true);
        } catch (problem) {
          if (!(problem instanceof HierarchyProblem)) throw problem;
          expect(problem.message).toMatch(/^hurt\.glb: /);
          ++refused;
        }
      }
    }
    expect(refused).toBeGreaterThan(100);
  });

  it.each([
    ['ghostCount', 'not a root'],
    ['borderCount', 'not a root'],
    ['interiorCount', 'not a root'],
  ])('refuses a root of too large a %s before anything is sized by it', async (key, problem) => {
    const hierarchy = workshop.build('plain', ['surface', '--triangles', '1500', '--colours'], config('none'));
    const bytes = bytesOf(path.join(hierarchy, 'tiles/00/000000.glb'));
    await expect(readTile(withCount(bytes, key, 60_000_000), 'root', null)).rejects.toThrow(problem);
  });

  it('refuses a compressed section that is not there before anything is sized by it', async () => {
    const hierarchy = workshop.build('packed', ['surface', '--triangles', '1500', '--colours'], config('meshopt'));
    const bytes = bytesOf(path.join(hierarchy, 'tiles/00/000000.glb'));
    const hurt = withJson(bytes, (text) => text.replace(/("EXT_meshopt_compression":\{[^}]*"byteLength":)\d+/, '$11e300'));
    await expect(readTile(hurt, 'root', null)).rejects.toThrow('outside the file');
  });

  it('knows a closed mesh, its inside and its outside', async () => {
    const closed = workshop.build('closed', ['surface', '--triangles', '1000', '--shape', 'torus'], config('none'));
    const root = await readTile(bytesOf(path.join(closed, 'tiles/00/000000.glb')), 'root', null);
    expect(root.closed).toBe(true);
    expect(root.insideOut).toBe(false);
    const turned = root.indices.slice().reverse();
    expect(isInsideOut(root.positions, turned)).toBe(true);
    const [minX, minY, minZ, maxX, maxY, maxZ] = root.box;
    const middle = [(minX + maxX) / 2, (minY + maxY) / 2, (minZ + maxZ) / 2] as const;
    expect(Math.abs(windingNumber(root, middle))).toBeLessThan(0.01); // the hole of the ring
    expect(Math.abs(windingNumber(root, [maxX + 1, maxY, maxZ]))).toBeLessThan(0.01);
    const inside = [0.5, 0.6, 0.7, 0.8, 0.9].map((part) => windingNumber(root, [middle[0] + (part * (maxX - minX)) / 2, middle[1], middle[2]]));
    expect(Math.max(...inside.map(Math.abs))).toBeGreaterThan(0.99);
  });
});
