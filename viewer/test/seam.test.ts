// SPDX-License-Identifier: MIT
// Any cut that the viewer assembles is the one that the program assembles, triangle by triangle.
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { gunzipSync } from 'node:zlib';
import { afterAll, describe, expect, it } from 'vitest';
import { Seam } from '../src/cut/seam.js';
import { isClosed } from '../src/hierarchy/closed.js';
import { readTile, type Tile } from '../src/hierarchy/tile.js';
import { Tree, keyOf, tilePath, type Node } from '../src/hierarchy/tree.js';
import { hasProgram, Workshop } from './support/meshhier.js';
import { random } from './support/random.js';

function randomCut(tree: Tree, next: () => number): Node[] {
  const cut: Node[] = [];
  const walk = (node: Node): void => {
    const children = tree.children(node);
    if (children.length === 0 || next() < 0.25) cut.push(node);
    else children.forEach(walk);
  };
  walk({ level: 0, index: 0 });
  return cut;
}

function triple(values: Float32Array | Uint8Array, at: number): Point {
  return [values[at], values[at + 1], values[at + 2]];
}

async function load(hierarchy: string, node: Node): Promise<Tile> {
  const bytes = readFileSync(path.join(hierarchy, tilePath(node)));
  return readTile(new Uint8Array(bytes[0] === 0x1f ? gunzipSync(bytes) : bytes), tilePath(node), null);
}

type Point = readonly [number, number, number];

/// A triangle as text, from its least corner on, so that lists can be compared.
function named(corners: readonly Point[]): string {
  const texts = corners.map((corner) => corner.join(' '));
  const least = texts.indexOf([...texts].sort()[0]);
  return [0, 1, 2].map((k) => texts[(least + k) % 3]).join('; ');
}

interface Assembled {
  readonly triangles: Point[][];
  /// The colours of each corner, where there are any: r, g, b.
  readonly colours: Point[][];
  readonly closed: boolean;
}

async function assembled(hierarchy: string, tree: Tree, cut: readonly Node[]): Promise<Assembled> {
  const tiles = await Promise.all(cut.map((node) => load(hierarchy, node)));
  const shown = new Map(cut.map((node, i) => [keyOf(node.level, node.index), tiles[i]]));
  const triangles: Point[][] = [];
  const colours: Point[][] = [];
  for (const tile of tiles) {
    const seam = new Seam(tile, tree);
    seam.look(shown);
    const drawn = tile.interiorCount + seam.resolve();
    for (let t = 0; t < 3 * drawn; t += 3) {
      const corners = [...tile.indices.subarray(t, t + 3)];
      triangles.push(corners.map((v) => triple(tile.positions, 3 * v)));
      if (tile.colours) colours.push(corners.map((v) => triple(tile.colours!, 4 * v)));
    }
  }
  return { triangles, colours, closed: isClosed(numbered(triangles)) };
}

/// Corners at the same place get the same number.
function numbered(triangles: readonly Point[][]): Uint32Array {
  const numbers = new Map<string, number>();
  return Uint32Array.from(triangles.flat(), (corner) => {
    const text = corner.join(' ');
    if (!numbers.has(text)) numbers.set(text, numbers.size);
    return numbers.get(text)!;
  });
}

/// The triangles of a binary PLY of float positions, 8-bit colours and 32-bit corners.
function readPly(bytes: Uint8Array): { triangles: Point[][]; colours: Point[][] } {
  const text = new TextDecoder('latin1').decode(bytes);
  const at = text.indexOf('end_header\n') + 'end_header\n'.length;
  const header = text.slice(0, at);
  const vertices = Number(/element vertex (\d+)/.exec(header)![1]);
  const faces = Number(/element face (\d+)/.exec(header)![1]);
  const colourAt = 4 * [...header.matchAll(/property float /g)].length;
  const stride = colourAt + [...header.matchAll(/property uchar /g)].length;
  const view = new DataView(bytes.buffer, bytes.byteOffset + at);
  const point = (v: number): Point => [0, 4, 8].map((k) => view.getFloat32(v * stride + k, true)) as unknown as Point;
  const colour = (v: number): Point => [0, 1, 2].map((k) => view.getUint8(v * stride + colourAt + k)) as unknown as Point;
  const corners = Array.from({ length: faces }, (_, f) =>
    [1, 5, 9].map((k) => view.getUint32(vertices * stride + f * 13 + k, true)));
  return { triangles: corners.map((t) => t.map(point)), colours: stride > colourAt ? corners.map((t) => t.map(colour)) : [] };
}

const CASES = {
  plain: { shape: 'torus', config: { partition: { vertices: 100 } } },
  compressed: { shape: 'torus', config: { partition: { count: 37 }, simplify: { vertices: 100 }, storage: { compression: 'meshopt_zlib' } } },
  rounded: { shape: 'torus', config: { partition: { count: 13 }, simplify: { vertices: 150 }, storage: { compression: 'meshopt', positions: { bits: 14 } } } },
  upright: { shape: 'torus', config: { up: 'z', partition: { vertices: 64 }, simplify: { method: 'half_edge' } } },
};

describe.skipIf(!hasProgram)('Seam', () => {
  const workshop = new Workshop();
  afterAll(() => {
    workshop.remove();
  });

  it.each(Object.entries(CASES))('assembles any cut as the program does: %s', async (name, { shape, config }) => {
    const hierarchy = workshop.build(name, ['surface', '--triangles', '4000', '--shape', shape], config);
    const manifest = JSON.parse(readFileSync(path.join(hierarchy, 'hierarchy.json'), 'utf8')) as { partitions: number; storage: { positions: { corner: number[] } | null } };
    const tree = new Tree(manifest.partitions);
    const corner = manifest.storage.positions?.corner ?? [0, 0, 0];
    const next = random(7);
    for (let round = 0; round < 12; ++round) {
      const cut = randomCut(tree, next);
      const { triangles, closed } = await assembled(hierarchy, tree, cut);
      const placed = triangles.map((corners) => corners.map((p) => p.map((x, k) => Math.fround(x + corner[k])) as unknown as Point));
      const expected = readPly(workshop.exportCut(hierarchy, cut.map(({ level, index }) => `${level}/${index}`)));
      expect(placed.map(named).sort()).toEqual(expected.triangles.map(named).sort());
      expect(closed).toBe(true);
    }
  });

  it.each(['charts', 'hard_edges', 'face_colours', 'soup'])('assembles any cut of a mesh with split vertices: %s', async (by) => {
    const hierarchy = workshop.buildSplit(by, ['surface', '--triangles', '4000', '--shape', 'torus'], by, { partition: { vertices: 100 } });
    const manifest = JSON.parse(readFileSync(path.join(hierarchy, 'hierarchy.json'), 'utf8')) as { partitions: number; source: { places: number; vertices: number } };
    expect(manifest.source.places).toBeLessThan(manifest.source.vertices);
    const tree = new Tree(manifest.partitions);
    const next = random(3);
    for (let round = 0; round < 12; ++round) {
      const cut = randomCut(tree, next);
      const { triangles, colours, closed } = await assembled(hierarchy, tree, cut);
      const expected = readPly(workshop.exportCut(hierarchy, cut.map(({ level, index }) => `${level}/${index}`)));
      const drawn = (corners: Point[], i: number, of: Point[][]): string => named(corners.map((corner, k) => [...corner, ...(of[i]?.[k] ?? [])] as unknown as Point));
      expect(triangles.map((corners, i) => drawn(corners, i, colours)).sort()).toEqual(expected.triangles.map((corners, i) => drawn(corners, i, expected.colours)).sort());
      expect(closed).toBe(true);
    }
  });
});
