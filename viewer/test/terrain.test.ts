// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { readTile, type Tile } from '../src/hierarchy/tile.js';
import { heightsOf, terrainOf } from '../src/scene/terrain.js';
import type { Vector } from '../src/cut/viewpoint.js';
import { tileBytes } from './support/tile_bytes.js';

const UP: Vector = [0, 0, 1];
const SIDE = 20;

/// A square of SIDE x SIDE whose vertices are where `place` says.
async function grid(place: (x: number, y: number) => readonly [number, number, number], flip = false): Promise<Tile> {
  const positions: number[] = [];
  const interior: number[] = [];
  for (let y = 0; y <= SIDE; ++y) for (let x = 0; x <= SIDE; ++x) positions.push(...place(x, y));
  for (let y = 0; y < SIDE; ++y)
    for (let x = 0; x < SIDE; ++x) {
      const a = y * (SIDE + 1) + x;
      const [b, c, d] = [a + 1, a + SIDE + 2, a + SIDE + 1];
      interior.push(...(flip ? [a, c, b, a, d, c] : [a, b, c, a, c, d]));
    }
  return readTile(tileBytes({ own: positions.length / 3, positions, interior }), 'tile.glb', null);
}

const hills = (x: number, y: number): readonly [number, number, number] => [x, y, Math.sin(x / 3) + Math.cos(y / 2)];
const ball = (x: number, y: number): readonly [number, number, number] => {
  const [a, b] = [(2 * Math.PI * x) / SIDE, (Math.PI * y) / SIDE];
  return [Math.sin(b) * Math.cos(a), Math.sin(b) * Math.sin(a), Math.cos(b) / 4];
};

describe('terrainOf', () => {
  it.each([false, true])('knows hills, whichever way their triangles are wound (%s)', async (flip) => {
    const terrain = terrainOf(await grid(hills, flip), UP);
    expect(terrain!.low).toBeGreaterThan(-2.01);
    expect(terrain!.high).toBeLessThan(2.01);
    expect(terrain!.slope).toBeGreaterThan(0.1);
    expect(terrain!.slope).toBeLessThan(0.6);
  });

  it('knows them upside down, and not lying on their side', async () => {
    const tile = await grid(hills);
    expect(terrainOf(tile, [0, 0, -1])).not.toBeNull();
    expect(terrainOf(tile, [0, 1, 0])).toBeNull();
  });

  it('knows a thin sheet on its side by its front, and none that is thick', async () => {
    const sheet = terrainOf(await grid((x, y) => [x, y, 0.1 * Math.sin(x / 3)]), [0, 1, 0])!;
    expect(sheet).toMatchObject({ along: [0, 0, 1], upright: false });
    expect(sheet.high - sheet.low).toBeGreaterThan(0.1);
    expect(terrainOf(await grid((x, y) => [x, y, 2 * Math.sin(x / 3)]), [0, 1, 0])).toBeNull();
    expect(terrainOf(await grid(hills), UP)).toMatchObject({ along: UP, upright: true });
  });

  it.each<[string, (x: number, y: number) => readonly [number, number, number]]>([
    ['a flat ball: half of it looks down', ball],
    ['a slope as high as it is wide', (x, y) => [x, y, x]],
    ['a plane', (x, y) => [x, y, 0]],
    ['a point', () => [1, 2, 3]],
  ])('knows that %s is none', async (_, place) => {
    expect(terrainOf(await grid(place), UP)).toBeNull();
  });

  it('knows that nothing is none', async () => {
    expect(terrainOf({ ...(await grid(hills)), interiorCount: 0 }, UP)).toBeNull();
    expect(terrainOf({ ...(await grid(hills)), own: 0, interiorCount: 0 }, UP)).toBeNull();
  });

  it('measures the slope', async () => {
    expect(terrainOf(await grid((x, y) => [x, y, 0.25 * x]), UP)!.slope).toBeCloseTo(0.25, 6);
  });

  it('leaves holes of the measurement out of the heights', async () => {
    const tile = await grid((x, y) => [x, y, x === 7 && y === 7 ? -32768 : x / 10]);
    const [low, high] = heightsOf(tile, UP);
    expect(low).toBe(0);
    expect(high).toBe(2);
  });
});
