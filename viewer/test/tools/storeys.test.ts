// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import type { Tile } from '../../src/hierarchy/tile.js';
import { hullFacing, isInterior } from '../../src/tools/interior.js';
import { storeysOf } from '../../src/tools/storeys.js';
import type { Vector } from '../../src/tools/vectors.js';
import { cube } from '../support/drawn.js';
import { house, HOUSE } from '../support/house.js';
import { random } from '../support/random.js';

type Triangles = Pick<ReturnType<typeof house>, 'positions' | 'corners'>;
type Mesh = Pick<Tile, 'positions' | 'indices' | 'interiorCount' | 'box' | 'closed'>;

const UP: Vector = [0, 1, 0];

function meshOf({ positions, corners }: Triangles, closed = false): Mesh {
  const along = (axis: number): number[] => positions.filter((_, i) => i % 3 === axis);
  const box = [Math.min, Math.max].flatMap((most) => [0, 1, 2].map((axis) => along(axis).reduce((a, b) => most(a, b), most())));
  return { positions: Float32Array.from(positions), indices: Uint32Array.from(corners), interiorCount: corners.length / 3, box, closed };
}

function turned({ positions, corners }: Triangles): Triangles {
  return { positions, corners: corners.map((_, i) => corners[i + [0, 1, -1][i % 3]]) };
}

/// A square of hills.
function hills(): Triangles {
  const side = 40;
  const positions = Array.from({ length: side * side }, (_, i) => [i % side, 3 * Math.sin(i * 0.37) * Math.cos((i / side) * 0.5), Math.floor(i / side)]).flat();
  const corners = Array.from({ length: (side - 1) ** 2 }, (_, i) => i + Math.floor(i / (side - 1))).flatMap((a) => [a, a + side, a + 1, a + 1, a + side, a + side + 1]);
  return { positions, corners };
}

describe('a hull', () => {
  it('of rooms seen from within looks away', () => {
    const { met, backs } = hullFacing(meshOf(house()), UP);
    expect(met).toBeGreaterThan(300);
    expect(backs).toBeGreaterThan(0.95 * met);
    expect(isInterior(meshOf(house()), UP)).toBe(true);
  });

  it('of a house with its outside does not', () => {
    expect(hullFacing(meshOf(house({ outside: true })), UP).backs).toBe(0);
    expect(isInterior(meshOf(house({ outside: true })), UP)).toBe(false);
  });

  it('of a terrain, or of one upside down, is none of rooms', () => {
    const { met, backs } = hullFacing(meshOf(hills()), UP);
    expect(backs).toBeLessThan(0.1 * met); // where its border is open

    expect([hills(), turned(hills())].map((mesh) => isInterior(meshOf(mesh), UP))).toEqual([false, false]);
  });

  it('of a body is none of rooms, even inside out', () => {
    const { tile } = cube();
    const body = { positions: [...tile.positions], corners: [...tile.indices] };
    expect([isInterior(meshOf(body, true), UP), isInterior(meshOf(turned(body), true), UP), isInterior(meshOf({ positions: [], corners: [] }), UP)]).toEqual([false, false, false]);
  });

  it('is judged the same each time', () => {
    expect(hullFacing(meshOf(house()), UP)).toEqual(hullFacing(meshOf(house()), UP));
  });
});

describe('storeys', () => {
  it('are found exactly, with furniture in them', () => {
    expect(storeysOf(meshOf(house()), UP)).toEqual(HOUSE.floors.map((floor, i) => ({ floor: expect.closeTo(floor, 6) as number, ceiling: expect.closeTo(HOUSE.ceilings[i], 6) as number })));
  });

  it('are found with noise of two centimetres', () => {
    const next = random(3);
    const { positions, corners } = house();
    const storeys = storeysOf(meshOf({ positions: positions.map((value) => value + 0.04 * (next() - 0.5)), corners }), UP);
    expect(storeys.length).toBe(2);
    storeys.forEach(({ floor, ceiling }, i) => {
      expect(Math.abs(floor - HOUSE.floors[i])).toBeLessThan(0.01);
      expect(Math.abs(ceiling - HOUSE.ceilings[i])).toBeLessThan(0.01);
    });
  });

  it('are found along another axis', () => {
    const { positions, corners } = house();
    const lying = positions.map((_, i) => positions[i + [0, 1, -1][i % 3]] * (i % 3 === 1 ? -1 : 1));
    expect(storeysOf(meshOf({ positions: lying, corners }), [0, 0, 1]).map(({ floor }) => Number(floor.toFixed(5)))).toEqual(HOUSE.floors);
  });

  it('are none of hills, of a body and of nothing', () => {
    const { tile } = cube();
    expect([hills(), { positions: [], corners: [] }].map((mesh) => storeysOf(meshOf(mesh), UP))).toEqual([[], []]);
    expect(storeysOf(meshOf({ positions: [...tile.positions], corners: [...tile.indices] }), UP)).toEqual([]);
  });
});
