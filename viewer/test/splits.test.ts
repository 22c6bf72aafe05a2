// SPDX-License-Identifier: MIT
// Vertices that a build gave several normals.
import { describe, expect, it } from 'vitest';
import { Seam } from '../src/cut/seam.js';
import { placeOf, verticesAt } from '../src/hierarchy/copies.js';
import { HierarchyProblem } from '../src/hierarchy/problem.js';
import { remoteFiles } from '../src/hierarchy/remote_files.js';
import { RemoteHierarchy } from '../src/hierarchy/remote_hierarchy.js';
import { readTile, type Tile } from '../src/hierarchy/tile.js';
import type { ExpectedCounts } from '../src/hierarchy/tile_counts.js';
import { checksum } from '../src/hierarchy/checksum.js';
import { TileDecoder } from '../src/hierarchy/tile_decoder.js';
import type { TileRecord } from '../src/hierarchy/tile_index.js';
import { Tree, keyOf } from '../src/hierarchy/tree.js';
import { sharedMaterials } from '../src/scene/materials.js';
import { DEFAULT_LOOK } from '../src/scene/settings.js';
import { TileObject, memoryOf, mostMemory, vertexBytesOf } from '../src/scene/tile_object.js';
import { packedTileBytes, tileBytes, type TileParts } from './support/tile_bytes.js';

async function read(parts: TileParts, change: Record<string, number> = {}, expected: ExpectedCounts | null = null): Promise<Tile> {
  return readTile(tileBytes(parts, change), 'tile.glb', expected);
}

const CORNERS = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1];
const AT = [0, 1, 2, 3, 0, 1, 0, 2, 2, 3, 3, 1]; // of each vertex its place
const DOWN = [0, 0, -127];
const LEFT = [-127, 0, 0];
const FRONT = [0, -127, 0];
const SLOPE = [73, 73, 73];

/// A tetrahedron of which each corner has a normal for each face. Corners 0 and 1 have copies, 4 and 5; behind them are splits of
/// places and, last, of a copy.
const TETRAHEDRON: TileParts = {
  own: 4,
  copyOf: [0, 1],
  splitOf: [0, 2, 2, 3, 3, 5],
  positions: AT.flatMap((place) => CORNERS.slice(3 * place, 3 * place + 3)),
  codes: [DOWN, DOWN, DOWN, FRONT, FRONT, FRONT, LEFT, LEFT, SLOPE, LEFT, SLOPE, SLOPE].flat(),
  interior: [0, 2, 1, 4, 5, 3, 6, 9, 7, 11, 8, 10],
};

describe('splits', () => {
  it('are at the places of their vertices', () => {
    const places = { own: 3, ghosts: 1, copyOf: Uint16Array.from([1, 3]), splitOf: Uint16Array.from([1, 1, 3, 4, 5]) };
    expect([0, 1, 2, 3].map((place) => [...verticesAt(places, place)])).toEqual([[0], [1, 6, 7, 4, 9], [2], [3, 8, 5, 10]]);
    expect([0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10].map((vertex) => placeOf(places, vertex))).toEqual([0, 1, 2, 3, 1, 3, 1, 1, 3, 1, 3]);
  });
});

describe('readTile', () => {
  it('knows a surface that is closed by place', async () => {
    const tile = await read(TETRAHEDRON);
    expect(tile.closed).toBe(true);
    expect(tile.insideOut).toBe(false);
    const open = await read({ ...TETRAHEDRON, interior: [...TETRAHEDRON.interior.slice(0, 9), 11, 8, 9, 10, 8, 9] });
    expect(open.closed).toBe(false);
  });

  it('keeps computed normals as the bytes that they are', async () => {
    const tile = await read(TETRAHEDRON);
    expect(tile.normalsFrom).toBe('build');
    expect(tile.normals).toBeInstanceOf(Int8Array);
    expect([...tile.normals]).toEqual(TETRAHEDRON.codes!.flatMap((value, i) => (i % 3 === 2 ? [value, 0] : [value])));
    expect([...tile.splitOf]).toEqual(TETRAHEDRON.splitOf);
  });

  it('reads the same of a compressed tile', async () => {
    expect(await readTile(await packedTileBytes(TETRAHEDRON), 'tile.glb', null)).toEqual(await read(TETRAHEDRON));
  });

  it('makes normals where a tile has none', async () => {
    const { own, interior } = TETRAHEDRON;
    const tile = await read({ own, positions: CORNERS, interior: interior.map((vertex) => AT[vertex]) });
    expect(tile.normalsFrom).toBe('viewer');
    expect(tile.normals.every((value, i) => (i % 4 === 3 ? value === 0 : i > 3 || value < -10_000))).toBe(true);
  });

  const painted = AT.flatMap((place) => [50 * place, 0, 0, 255]);
  const given = TETRAHEDRON.codes!.map((value) => value / 127);
  it.each<[string, Partial<TileParts>, Record<string, number>, string]>([
    ['splits out of order', { splitOf: [0, 2, 3, 2, 3, 5] }, {}, 'splits are not in order'],
    ['a split of a split', { splitOf: [0, 2, 2, 3, 3, 6] }, {}, 'splits are not in order'],
    ['splits without their section', {}, { splitOf: -1 }, 'section -1 has not the 12 bytes'],
    ['splits of another section', {}, { splitOf: 0 }, 'section 0 has not the 12 bytes'],
    ['fewer splits than their section has', {}, { splitCount: 5 }, 'has not the 10 bytes'],
    ['a count of splits that is none', {}, { splitCount: 0.5 }, '"splitCount" is not from'],
    ['more splits than corners, before anything is sized by them', {}, { splitCount: 13 }, 'more splits than corners'],
    ['a corner behind the last split', { interior: [...TETRAHEDRON.interior.slice(0, 11), 12] }, {}, 'names a vertex that is not there'],
    ['a split elsewhere', { positions: TETRAHEDRON.positions.map((x, i) => (i === 35 ? x + 1 : x)) }, {}, 'differs from its vertex'],
    ['a split of another colour', { colours: painted.map((value, i) => (i === 44 ? value + 1 : value)) }, {}, 'differs from its vertex'],
    ['normals of unsigned bytes', { codeAccessor: { componentType: 5121 } }, {}, 'normals of an unknown type'],
    ['normals of 16 bits', { codeAccessor: { componentType: 5122 } }, {}, 'normals of an unknown type'],
    ['normals that are not normalized', { codeAccessor: { normalized: false } }, {}, 'normals of an unknown type'],
    ['normals of four numbers', { codeAccessor: { type: 'VEC4' } }, {}, 'normals of an unknown type'],
    ['normals of floats that are bytes', { codeAccessor: { componentType: 5126 } }, {}, 'has not the 144 bytes'],
    ['fewer normals than vertices', { codes: TETRAHEDRON.codes!.slice(3) }, {}, 'has not the 48 bytes'],
    ['splits of given normals', { codes: undefined, normals: given }, {}, 'splits without computed normals'],
    ['splits without normals', { codes: undefined }, {}, 'splits without computed normals'],
  ])('refuses %s', async (_, parts, change, problem) => {
    const refused = read({ ...TETRAHEDRON, ...parts }, change);
    await expect(refused).rejects.toBeInstanceOf(HierarchyProblem);
    await expect(refused).rejects.toThrow(problem);
  });

  it('refuses a tile with other splits than the index tells of', async () => {
    const expected = { level: 0, index: 0, own: 4, ghosts: 0, copies: 2, splits: 6, interior: 4, border: 0, pictureWidth: 0, pictureHeight: 0, hasNormalMap: false };
    await expect(read(TETRAHEDRON, {}, expected)).resolves.toBeDefined();
    await expect(read(TETRAHEDRON, {}, { ...expected, splits: 5 })).rejects.toThrow('not the tile that the index tells of');
  });

  it('takes a split with the colour of its vertex', async () => {
    await expect(read({ ...TETRAHEDRON, colours: painted })).resolves.toBeDefined();
  });

  it("refuses an interior triangle with a corner at a ghost's split", async () => {
    await expect(read({ ...FINE, interior: [0, 1, 8] })).rejects.toThrow('an interior triangle names a ghost');
  });
});

const UP = [0, 0, 127];
const SIDE = [127, 0, 0];
const RED = [255, 0, 0, 255];
const BLUE = [0, 0, 255, 255];

/// Tile 2/2 of four partitions: vertices 0 and 1, ghosts 2 and 3 of 2/1, a blue copy 4 of ghost 2; splits 5 of vertex 0, 6 of
/// ghost 2, 7 of ghost 3 and 8 of the copy. Two border triangles with a crease between them.
const FINE: TileParts = {
  level: 2, index: 2, own: 2, ghosts: 2,
  copyOf: [2],
  splitOf: [0, 2, 3, 4],
  positions: [0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 1, 1, 0, 0, 1, 0],
  codes: [UP, UP, UP, UP, UP, SIDE, SIDE, SIDE, SIDE].flat(),
  colours: [RED, RED, RED, RED, BLUE, RED, RED, RED, BLUE].flat(),
  interior: [],
  border: [0, 1, 2, 5, 7, 8],
  neighbours: [1], ghostStarts: [0, 2], chains: [0, 1, 1, 0],
};

const NEARLY_UP = [10, 0, 126];
const NEARLY_SIDE = [120, 0, 41];
const SLANTED = [0, 100, 78];

/// Tile 2/1 is part of this one, one level up. Vertex 1 is red and looks up, its blue copy 3 to the side, as the copy's split 5 does less;
/// split 4 of vertex 1 looks aside too. Vertex 0 has one normal.
const COARSE: TileParts = {
  level: 1, index: 0, own: 3,
  copyOf: [1],
  splitOf: [1, 3],
  positions: [1, 2, 0, 0, 2, 0, 5, 5, 5, 0, 2, 0, 0, 2, 0, 0, 2, 0],
  codes: [SLANTED, SLANTED, UP, NEARLY_SIDE, SLANTED, NEARLY_UP].flat(),
  colours: [BLUE, RED, RED, BLUE, RED, BLUE].flat(),
  interior: [0, 1, 2],
};

/// 2/1 itself: the same places as the ghosts.
const BESIDE: TileParts = {
  level: 2, index: 1, own: 3,
  positions: [0, 1, 0, 1, 1, 0, 5, 5, 5],
  codes: [SLANTED, SLANTED, UP].flat(),
  colours: [RED, RED, RED].flat(),
  interior: [0, 1, 2],
};

describe('Seam', () => {
  const tree = new Tree(4);
  const ghosts = [2, 6, 4, 8, 3, 7];
  const points = (tile: Tile): number[][] => ghosts.map((v) => [...tile.positions.subarray(3 * v, 3 * v + 3)]);
  const normals = (tile: Tile): number[][] => ghosts.map((v) => [...tile.normals.subarray(4 * v, 4 * v + 3)]);
  const colours = (tile: Tile): number[][] => ghosts.map((v) => [...tile.colours!.subarray(4 * v, 4 * v + 4)]);
  const shown = (...tiles: Tile[]): Map<number, Tile> => new Map(tiles.map((tile) => [keyOf(tile.level, tile.index), tile]));

  it('moves a ghost with its splits, each to the normal most like its own', async () => {
    const [fine, coarse] = [await read(FINE), await read(COARSE)];
    const seam = new Seam(fine, tree);
    seam.look(shown(fine, coarse));
    expect(seam.resolve()).toBe(2);
    expect(points(fine)).toEqual([[0, 2, 0], [0, 2, 0], [0, 2, 0], [0, 2, 0], [1, 2, 0], [1, 2, 0]]);
    expect(normals(fine)).toEqual([NEARLY_UP, NEARLY_SIDE, NEARLY_UP, NEARLY_SIDE, SLANTED, SLANTED]);
    expect([...fine.normals.subarray(0, 4), ...fine.normals.subarray(20, 24)]).toEqual([...UP, 0, ...SIDE, 0]);
  });

  it('colours it as if there were no computed normals', async () => {
    const plain = async (parts: TileParts): Promise<Tile> => {
      const { splitOf = [], positions, colours: painted = [], border: seams = [] } = parts;
      const vertices = positions.length / 3 - splitOf.length;
      const vertexOf = (v: number): number => (v < vertices ? v : splitOf[v - vertices]);
      const [interior, border] = [parts.interior, seams].map((corners) => corners.map(vertexOf));
      const unsplit = { splitOf: [], codes: undefined, positions: positions.slice(0, 3 * vertices), colours: painted.slice(0, 4 * vertices) };
      return read({ ...parts, ...unsplit, interior, border });
    };
    const drawnColours = ({ colours: painted, indices }: Tile): number[][] => [...indices].map((v) => [...painted!.subarray(4 * v, 4 * v + 4)]);
    const drawn = await Promise.all([read, plain].map(async (make) => {
      const [fine, coarse] = [await make(FINE), await make(COARSE)];
      const seam = new Seam(fine, tree);
      seam.look(shown(fine, coarse));
      seam.resolve();
      return fine;
    }));
    expect(drawnColours(drawn[0])).toEqual([RED, RED, RED, RED, BLUE, BLUE]);
    expect(drawnColours(drawn[1])).toEqual(drawnColours(drawn[0]));
  });

  it('brings them back beside a neighbour of the same level', async () => {
    const [fine, coarse, beside] = [await read(FINE), await read(COARSE), await read(BESIDE)];
    const before = [points(fine), normals(fine), colours(fine)];
    const seam = new Seam(fine, tree);
    seam.look(shown(fine, coarse));
    seam.resolve();
    expect(points(fine)).not.toEqual(before[0]);
    expect(seam.look(shown(fine, beside))).toBe(true);
    expect(seam.resolve()).toBe(0); // the one with the smaller number draws them
    expect([points(fine), normals(fine), colours(fine)]).toEqual(before);
  });

  it('draws no triangle of which two corners come to one place', async () => {
    const [fine, coarse] = [await read({ ...FINE, chains: [0, 1, 1, 1] }), await read(COARSE)];
    const seam = new Seam(fine, tree);
    seam.look(shown(fine, coarse));
    expect(seam.resolve()).toBe(1);
    expect([...fine.indices.subarray(0, 3)]).toEqual([0, 1, 2]);
  });

  it('takes no more memory than its counts say, and less than with given normals', async () => {
    const [fine, given] = [await read(FINE), await read({ ...FINE, splitOf: [], codes: undefined, copyOf: [0, 2, 2, 2, 3], border: [0, 1, 2, 4, 8, 7], normals: FINE.codes!.map((value) => value / 127) })];
    const bytes = memoryOf(fine, new Seam(fine, tree), true);
    const most = (splits: number): number =>
      mostMemory({ own: 2, ghosts: 2, copies: 1, splits, interior: 0, border: 2, pictureWidth: 0, pictureHeight: 0, hasNormalMap: false }, { level: 2, vertexBytes: vertexBytesOf(fine), wires: true, texelBytes: { plain: 4, mapped: 4 } });
    expect(vertexBytesOf(fine)).toBe(20);
    expect(bytes).toBeLessThanOrEqual(most(4));
    expect(most(4) - most(3)).toBeGreaterThanOrEqual(2 * 20);
    expect(memoryOf(given, new Seam(given, tree), true) - bytes).toBe(2 * 9 * 4 + 7 * 4); // drawn here and on the GPU, and of ghosts as in the file
  });

  it('hands the bytes to the GPU', async () => {
    const tile = await read(TETRAHEDRON);
    const resident = { node: { level: 0, index: 0 }, key: keyOf(0, 0), tile, seam: new Seam(tile, new Tree(1)) };
    const { normal } = new TileObject(resident, DEFAULT_LOOK, sharedMaterials()).geometry.attributes;
    expect(normal.array).toBe(tile.normals);
    expect([normal.itemSize, normal.normalized, normal.count]).toEqual([4, true, 12]);
    expect([normal.getX(0), normal.getY(0), normal.getZ(0)]).toEqual([0, 0, -1]);
  });
});

describe('RemoteHierarchy', () => {
  it('refuses a tile whose normals are of another kind than the root has', async () => {
    const [computed, none] = [{ ...TETRAHEDRON, level: 1 }, { own: 4, positions: CORNERS, interior: [0, 2, 1], level: 1 }];
    const files: Record<string, TileParts> = { 'tiles/00/000000.glb': TETRAHEDRON, 'tiles/01/000000.glb': computed, 'tiles/01/000001.glb': { ...none, index: 1 } };
    const fetch = async (url: string): Promise<Response> => Promise.resolve(new Response(tileBytes(files[url.slice('here/'.length)]) as Uint8Array<ArrayBuffer>));
    const { signal } = new AbortController();
    const remote = new RemoteHierarchy(remoteFiles('here', fetch), new TileDecoder(undefined, 0), signal);
    await remote.root();
    const record = (parts: TileParts): TileRecord => {
      const { own, copyOf = [], splitOf = [], interior } = parts;
      const bytes = tileBytes(parts);
      return { own, ghosts: 0, copies: copyOf.length, splits: splitOf.length, interior: interior.length / 3, border: 0, pictureWidth: 0, pictureHeight: 0, hasNormalMap: false, error: 0, bound: 0, min: [0, 0, 0], max: [1, 1, 1], bytes: bytes.length, checksum: checksum(bytes) };
    };
    await expect(remote.tile({ level: 1, index: 0 }, record(computed), signal)).resolves.toBeDefined();
    await expect(remote.tile({ level: 1, index: 1 }, record({ ...none, index: 1 }), signal)).rejects.toThrow('tiles/01/000001.glb: its normals are not of the kind that the root has');
  });
});
