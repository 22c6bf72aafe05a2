// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { nearestOf, passes, WalkSpace } from '../../src/tools/walk_space.js';
import { bodyOf, Walker, type Feet } from '../../src/tools/walker.js';
import { house, HOUSE, type Plan } from '../support/house.js';
import { random } from '../support/random.js';

const EYE = 1.6;
const GRAVITY = 9.81;
const body = bodyOf(EYE);
const AT_SEVEN = { x: expect.closeTo(7, 6) as number, y: 0, z: 5 };
const TOUCH = 1e-3; // of what is allowed: rounding

function spaceOf({ positions, corners }: { readonly positions: readonly number[]; readonly corners: readonly number[] }): WalkSpace {
  return new WalkSpace(Float64Array.from(corners.flatMap((corner) => positions.slice(3 * corner, 3 * corner + 3))));
}

function squares(rows: readonly (readonly number[])[]): WalkSpace {
  return new WalkSpace(Float64Array.from(rows.flat()));
}

/// A level rectangle.
function level([x0, z0, x1, z1]: Plan, y: number): number[] {
  return [x0, y, z0, x1, y, z0, x1, y, z1, x0, y, z0, x1, y, z1, x0, y, z1];
}

/// How far a place is from a rectangle in plan; 0 in it.
function away([x0, z0, x1, z1]: Plan, { x, z }: Feet): number {
  return Math.hypot(Math.max(x0 - x, 0, x - x1), Math.max(z0 - z, 0, z - z1));
}

/// Why nobody can stand there; empty: one can.
function problemAt(feet: Feet): string {
  const { size: [x, z], wall, door, floors, stairs } = HOUSE;
  const least = body.radius * (1 - TOUCH) - TOUCH;
  if (Math.min(feet.x, feet.z, x - feet.x, z - feet.z) < least) return 'in an outer wall';
  const isUp = feet.y > floors[1] - stairs.rise - TOUCH;
  const [a, b] = [isUp ? wall.upper : wall.ground, isUp ? door.upper : door.ground];
  const isAcross = a[3] - a[1] > a[2] - a[0];
  const parts: Plan[] = isAcross ? [[a[0], a[1], a[2], b[1]], [a[0], b[3], a[2], a[3]]] : [[a[0], a[1], b[0], a[3]], [b[2], a[1], a[2], a[3]]];
  if (parts.some((part) => away(part, feet) < least)) return 'in a wall';
  if (!isUp && feet.y < 0.5 && [HOUSE.table, HOUSE.cupboard].some((each) => away(each, feet) < least)) return 'in furniture';
  if (feet.y > floors[1] - TOUCH && away(HOUSE.bed, feet) < least) return 'in the bed';
  const onFloor = floors.some((floor) => Math.abs(feet.y - floor) < TOUCH);
  const isOnStairs = away(stairs.plan, feet) < body.radius;
  return onFloor || isOnStairs ? '' : 'on nothing';
}

function rested(walker: Walker, space: WalkSpace, feet: Feet): Feet {
  let now = feet;
  for (let i = 0; i < 200; ++i) now = walker.fall(space, now, 0.05, GRAVITY);
  return now;
}

describe('a walker in a house', () => {
  const space = spaceOf(house({ cell: 4 }));

  it('is nowhere where nobody can stand, on 10,000 random walks', () => {
    const next = random(7);
    const problems: string[] = [];
    let [walks, upstairs] = [0, 0];
    while (walks < 10_000) {
      const walker = new Walker(body);
      let feet: Feet = { x: next() * 10, z: next() * 8, y: next() < 0.5 ? 0 : 2.8 };
      if (problemAt(feet) !== '' || !walker.fits(space, feet)) continue;
      feet = walker.fall(space, feet, 10, GRAVITY);
      ++walks;
      const angle = 2 * Math.PI * next();
      for (let i = 0; i < 6; ++i) {
        const turned = angle + (next() - 0.5) * 2;
        feet = walker.move(space, feet, { x: 0.7 * Math.cos(turned), z: 0.7 * Math.sin(turned) });
        feet = walker.fall(space, feet, 10, GRAVITY);
        const problem = problemAt(feet);
        if (problem !== '') problems.push(`${problem}: ${JSON.stringify(feet)}`);
      }
      if (feet.y > 2) ++upstairs;
    }
    expect(problems.slice(0, 5)).toEqual([]);
    expect(upstairs).toBeGreaterThan(1000);
  });

  it('climbs the stairs, and comes down again', () => {
    const walker = new Walker(body);
    let feet: Feet = { x: 9.5, y: 0, z: 0.5 };
    const heights: number[] = [];
    for (let i = 0; i < 60; ++i) {
      feet = walker.move(space, feet, { x: 0, z: 0.1 });
      feet = walker.fall(space, feet, 0.1, GRAVITY);
      heights.push(feet.y);
    }
    expect(feet.y).toBeCloseTo(2.8, 9);
    expect(feet.z).toBeGreaterThan(5);
    expect(heights.every((height, i) => i === 0 || (height > heights[i - 1] - TOUCH && height - heights[i - 1] < 0.41))).toBe(true);
    feet = walker.move(space, feet, { x: 0, z: -5 });
    expect(rested(walker, space, feet).y).toBeLessThan(0.3);
  });

  it('passes the door, and slides along a wall', () => {
    const walker = new Walker(body);
    expect(walker.move(space, { x: 5, y: 0, z: 4 }, { x: 3, z: 0 }).x).toBeCloseTo(8, 6);
    const along = walker.move(space, { x: 5.5, y: 0, z: 6 }, { x: 1, z: 1 });
    expect(along.x).toBeCloseTo(5.9 - body.radius, 2);
    expect(along.z).toBeGreaterThan(6.3);
    expect(walker.move(space, { x: 5, y: 0, z: 6 }, { x: 3, z: 0 }).x).toBeCloseTo(5.9 - body.radius, 2);
  });

  it('has eyes at its height above a slope, and walks down it', () => {
    const slope = squares([[0, 0, -5, 20, 8, -5, 20, 8, 5], [0, 0, -5, 20, 8, 5, 0, 0, 5]]);
    const walker = new Walker(body);
    let feet = walker.move(slope, { x: 2, y: 0.8, z: 0 }, { x: 10, z: 0 });
    expect([feet.x, feet.y]).toEqual([expect.closeTo(12, 6), expect.closeTo(4.8, 6)]);
    feet = walker.move(slope, feet, { x: -10, z: 0 });
    expect(feet.y).toBeCloseTo(0.8, 6);
  });

  it('stops at the end of the world, walks over a hole, and falls to the floor below', () => {
    const walker = new Walker(body);
    const island = squares([level([0, 0, 10, 10], 0)]);
    expect(walker.move(island, { x: 5, y: 0, z: 5 }, { x: 50, z: 0 }).x).toBeLessThan(10.2);
    const holed = squares([level([0, 0, 5, 10], 0), level([5.3, 0, 10, 10], 0)]);
    expect(walker.move(holed, { x: 4, y: 0, z: 5 }, { x: 3, z: 0 })).toEqual(AT_SEVEN);
    const ledge = squares([level([0, 0, 5, 10], 3), level([0, 0, 10, 10], 0)]);
    const fallen = rested(walker, ledge, walker.move(ledge, { x: 4, y: 3, z: 5 }, { x: 3, z: 0 }));
    expect(fallen).toEqual(AT_SEVEN);
  });

  it('stays on its feet when finer tiles come', () => {
    const walker = new Walker(body);
    const floors = (y: number): WalkSpace => squares([level([0, 0, 10, 10], y), level([0, 0, 10, 10], -3)]);
    for (const y of [0.1, -0.1, 0.7, -0.6]) expect(walker.again(floors(y), { x: 5, y: 0, z: 5 }).y).toBe(y);
    // a wall that is there now, around the middle of the walker: it comes out of it
    const boxed = squares([level([0, 0, 10, 10], 0), level([4.8, 4.8, 5.2, 5.2], 1)]);
    expect(walker.move(boxed, { x: 5, y: 0, z: 5 }, { x: 2, z: 0 }).x).toBeGreaterThan(6.9);
  });
});

describe('what stands in the way', () => {
  it('is what lies between two heights, in plan', () => {
    const wall = squares([[0, 0, 0, 4, 0, 0, 4, 3, 0]]);
    const [polygon] = wall.obstacles({ x: 2, z: 0 }, 3, 1, 2);
    expect(Math.min(...polygon.map(([x]) => x))).toBeCloseTo(4 / 3);
    expect(wall.obstacles({ x: 2, z: 0 }, 3, 3.1, 4)).toEqual([]);
    expect(nearestOf(polygon, { x: 3, z: 2 })).toEqual({ x: 3, z: 0 });
    expect([passes(polygon, { x: 3, z: 1 }, { x: 3, z: -1 }), passes(polygon, { x: 1, z: 1 }, { x: 1, z: -1 }), passes(polygon, { x: 3, z: 1 }, { x: 3, z: 0.5 })]).toEqual([true, false, false]);
  });

  it('of nothing is nothing', () => {
    const none = new WalkSpace(new Float64Array(0));
    expect([none.ground({ x: 0, z: 0 }, 9), none.obstacles({ x: 0, z: 0 }, 1, 0, 1)]).toEqual([-Infinity, []]);
  });
});
