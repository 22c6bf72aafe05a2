// SPDX-License-Identifier: MIT
// Places with several vertices: seams of texture coordinates, hard edges.
import { describe, expect, it } from 'vitest';
import { Seam } from '../src/cut/seam.js';
import { firstOf, toPlaces } from '../src/hierarchy/copies.js';
import { HierarchyProblem } from '../src/hierarchy/problem.js';
import { readTile, type Tile } from '../src/hierarchy/tile.js';
import type { ExpectedCounts } from '../src/hierarchy/tile_counts.js';
import { Tree, keyOf } from '../src/hierarchy/tree.js';
import { memoryOf, mostMemory, vertexBytesOf } from '../src/scene/tile_object.js';
import { tileBytes, type TileParts } from './support/tile_bytes.js';

async function read(parts: TileParts, change: Record<string, number> = {}, expected: ExpectedCounts | null = null): Promise<Tile> {
  return readTile(tileBytes(parts, change), 'tile.glb', expected);
}

const CORNERS = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1];

/// A tetrahedron of which each face has vertices of its own.
const TETRAHEDRON: TileParts = {
  own: 4,
  copyOf: [0, 0, 1, 1, 2, 2, 3, 3],
  positions: [...CORNERS, ...[0, 0, 1, 1, 2, 2, 3, 3].flatMap((place) => CORNERS.slice(3 * place, 3 * place + 3))],
  interior: [0, 2, 1, 4, 6, 3, 5, 10, 8, 7, 9, 11],
};

describe('copies', () => {
  it('finds the copies of a place', () => {
    const copyOf = Uint16Array.from([0, 2, 2, 5]);
    expect([0, 1, 2, 3, 5, 6].map((place) => firstOf(copyOf, place))).toEqual([0, 1, 1, 3, 3, 4]);
    expect(toPlaces({ own: 6, ghosts: 0, copyOf, splitOf: new Uint16Array(0) }, Uint16Array.from([1, 6, 9]))).toEqual(Uint16Array.from([1, 0, 5]));
  });
});

describe('readTile', () => {
  it('knows a surface that is closed by place, and gives all vertices of a place one normal', async () => {
    const tile = await read(TETRAHEDRON);
    expect(tile.closed).toBe(true);
    expect(tile.insideOut).toBe(false);
    expect([...tile.copyOf]).toEqual(TETRAHEDRON.copyOf);
    const normalOf = (vertex: number): number[] => [...tile.normals.subarray(4 * vertex, 4 * vertex + 3)];
    tile.copyOf.forEach((place, copy) => {
      expect(normalOf(4 + copy)).toEqual(normalOf(place));
    });
    expect(normalOf(0).every((value) => value < -10_000)).toBe(true);
  });

  it("keeps the file's normals of each vertex", async () => {
    const normals = TETRAHEDRON.positions.map((_, i) => ((i % 7) - 3) / 3);
    const tile = await read({ ...TETRAHEDRON, normals });
    expect(tile.normalsFrom).toBe('input');
    normals.forEach((value, i) => {
      expect(tile.normals[4 * Math.floor(i / 3) + (i % 3)]).toBe(Math.round(32767 * value));
    });
  });

  it.each<[string, Partial<TileParts>, Record<string, number>, string]>([
    ['copies out of order', { copyOf: [0, 1, 0, 1, 2, 2, 3, 3] }, {}, 'copies are not in order'],
    ['a copy of no vertex', { copyOf: [0, 0, 1, 1, 2, 2, 3, 4] }, {}, 'copies are not in order'],
    ['more copies than there are places of', {}, { copyCount: 9 }, 'has not the'],
    ['a count that is none', {}, { copyCount: -1 }, '"copyCount" is not from'],
    ['a corner behind the last copy', { interior: [0, 2, 12] }, {}, 'names a vertex that is not there'],
    ['a version that is older', {}, { version: 1 }, 'version 1 of MESHHIER_tile is not known'],
  ])('refuses %s', async (_, parts, change, problem) => {
    const refused = read({ ...TETRAHEDRON, ...parts }, change);
    await expect(refused).rejects.toBeInstanceOf(HierarchyProblem);
    await expect(refused).rejects.toThrow(problem);
  });

  it('refuses a tile with other copies than the index tells of', async () => {
    const expected = { level: 0, index: 0, own: 4, ghosts: 0, copies: 8, splits: 0, interior: 4, border: 0, pictureWidth: 0, pictureHeight: 0, hasNormalMap: false };
    await expect(read(TETRAHEDRON, {}, expected)).resolves.toBeDefined();
    await expect(read(TETRAHEDRON, {}, { ...expected, copies: 7 })).rejects.toThrow('not the tile that the index tells of');
  });

  it("refuses an interior triangle with a corner at a ghost's copy", async () => {
    const { positions, ...fine } = FINE;
    await expect(read({ ...fine, positions, interior: [0, 1, 6] })).rejects.toThrow('an interior triangle names a ghost');
  });
});

const UP = [0, 0, 1];
const SIDE = [1, 0, 0];

/// Tile 2/2 of four partitions: vertices 0 and 1, ghosts 2 and 3 of 2/1, the ghosts' copies 5 and 6, and one of vertex 0, 4. Two
/// border triangles with a hard edge between them.
const FINE: TileParts = {
  level: 2, index: 2, own: 2, ghosts: 2,
  copyOf: [0, 2, 3],
  positions: [0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 0, 0, 1, 0, 1, 1, 0],
  normals: [...UP, ...UP, ...UP, ...UP, ...SIDE, ...SIDE, ...SIDE],
  interior: [],
  border: [0, 1, 2, 4, 6, 5],
  neighbours: [1], ghostStarts: [0, 2], chains: [0, 1, 1, 0],
};

/// Tile 2/1 is part of this one, one level up: vertex 0 with one normal, vertex 1 with two.
const COARSE: TileParts = {
  level: 1, index: 0, own: 3,
  copyOf: [1],
  positions: [1, 2, 0, 0, 2, 0, 5, 5, 5, 0, 2, 0],
  normals: [0, 0.6, 0.8, 0.8, 0, 0.6, 0, 1, 0, 0.1, 0, 0.99],
  interior: [0, 1, 2],
};

/// 2/1 itself: the same places as the ghosts.
const BESIDE: TileParts = {
  level: 2, index: 1, own: 3,
  copyOf: [0, 1],
  positions: [0, 1, 0, 1, 1, 0, 5, 5, 5, 0, 1, 0, 1, 1, 0],
  normals: [...UP, ...UP, ...UP, ...SIDE, ...SIDE],
  interior: [0, 1, 2],
};

describe('Seam', () => {
  const tree = new Tree(4);
  const points = (tile: Tile, vertices: readonly number[]): number[][] => vertices.map((v) => [...tile.positions.subarray(3 * v, 3 * v + 3)]);
  const normals = (tile: Tile, vertices: readonly number[]): number[][] =>
    vertices.map((v) => [...tile.normals.subarray(4 * v, 4 * v + 3)].map((value) => Math.round((100 * value) / 32767) / 100));
  const shown = (...tiles: Tile[]): Map<number, Tile> => new Map(tiles.map((tile) => [keyOf(tile.level, tile.index), tile]));

  it('moves a ghost with its copies, each to the vertex most like it', async () => {
    const [fine, coarse] = [await read(FINE), await read(COARSE)];
    const seam = new Seam(fine, tree);
    seam.look(shown(fine, coarse));
    expect(seam.resolve()).toBe(2);
    expect(points(fine, [2, 5])).toEqual([[0, 2, 0], [0, 2, 0]]);
    expect(points(fine, [3, 6])).toEqual([[1, 2, 0], [1, 2, 0]]);
    expect(normals(fine, [2, 5, 3, 6])).toEqual([[0.1, 0, 0.99], [0.8, 0, 0.6], [0, 0.6, 0.8], [0, 0.6, 0.8]]);
    expect(points(fine, [0, 4])).toEqual([[0, 0, 0], [0, 0, 0]]);
    expect(normals(fine, [0, 4])).toEqual([UP, SIDE]);
  });

  it('brings them back beside a neighbour of the same level', async () => {
    const [fine, coarse, beside] = [await read(FINE), await read(COARSE), await read(BESIDE)];
    const before = [points(fine, [2, 5, 3, 6]), normals(fine, [2, 5, 3, 6])];
    const seam = new Seam(fine, tree);
    seam.look(shown(fine, coarse));
    seam.resolve();
    expect(seam.look(shown(fine, beside))).toBe(true);
    expect(seam.resolve()).toBe(0); // the one with the smaller number draws them
    expect([points(fine, [2, 5, 3, 6]), normals(fine, [2, 5, 3, 6])]).toEqual(before);
  });

  it('draws no triangle of which two corners come to one place', async () => {
    const [fine, coarse] = [await read({ ...FINE, chains: [0, 1, 1, 1] }), await read(COARSE)];
    const seam = new Seam(fine, tree);
    seam.look(shown(fine, coarse));
    expect(seam.resolve()).toBe(1);
    expect([...fine.indices.subarray(0, 3)]).toEqual([0, 1, 2]);
  });

  it('takes no more memory than the index says, though all it has are copies', async () => {
    const copies = Array<number>(40).fill(0);
    const each = (values: readonly number[]): number[] => [0, ...copies].flatMap(() => values);
    const tile = await read({ own: 1, copyOf: copies, positions: each([0, 0, 0]), normals: each(UP), colours: each([9, 9, 9, 255]), interior: [0, 1, 2] });
    const counts = { own: 1, ghosts: 0, copies: 40, splits: 0, interior: 1, border: 0, pictureWidth: 0, pictureHeight: 0, hasNormalMap: false };
    const most = mostMemory(counts, { level: 0, vertexBytes: vertexBytesOf(tile), wires: false, texelBytes: { plain: 4, mapped: 4 } });
    expect(memoryOf(tile, new Seam(tile, new Tree(1)), false)).toBeLessThanOrEqual(most);
  });

  it('takes no more memory than the index says', async () => {
    const fine = await read(FINE);
    const seam = new Seam(fine, tree);
    const counts = { own: 2, ghosts: 2, copies: 3, splits: 0, interior: 0, border: 2, pictureWidth: 0, pictureHeight: 0, hasNormalMap: false };
    expect(memoryOf(fine, seam, true)).toBeLessThanOrEqual(mostMemory(counts, { level: 2, vertexBytes: vertexBytesOf(fine), wires: true, texelBytes: { plain: 4, mapped: 4 } }));
    expect(memoryOf(fine, seam, true)).toBeGreaterThan(memoryOf(await read({ ...FINE, copyOf: [], border: [0, 1, 2, 0, 3, 2], positions: FINE.positions.slice(0, 12), normals: FINE.normals!.slice(0, 12) }), seam, true));
  });
});
