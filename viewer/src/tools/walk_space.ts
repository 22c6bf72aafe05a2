// SPDX-License-Identifier: MIT
// Problem: what stands in a walker's way, and what lies below, among any triangles?
// Idea: of all that is between knees and head, the shadow on the ground is what one walks around: each triangle is cut off at both heights,
// and what is left is a convex polygon in plan, mostly a mere line, of a wall.
//
//      head  - - - - - - /- - -            in plan:   |
//                       / |                           |    (o)  <- a disk, upright
//      knees - - - - - /- |- -                        |
//               floor ____|___ (not in the way: it is stepped upon)
//
// Invariant: edges that two triangles share are cut at the same places, so walls have no gaps. Cost: O(triangles held) a question.
import type { Vector } from './vectors.js';

/// In plan: x and z of corners.
export type Polygon = readonly (readonly [number, number])[];

export interface Plan {
  readonly x: number;
  readonly z: number;
}

const COORDINATES = 9; // of a triangle
const FLAT = 1e-12; // area in plan, in parts of a triangle's extent squared: below, it is upright

/// Where the way from `a` to `b` passes a height; the same whichever of the two comes first.
function passing(a: Vector, b: Vector, height: number): Vector {
  const [low, high] = a[1] < b[1] ? [a, b] : [b, a];
  const t = (height - low[1]) / (high[1] - low[1]);
  return [low[0] + t * (high[0] - low[0]), height, low[2] + t * (high[2] - low[2])];
}

/// The part of a polygon above a height (`sign` 1) or below it (-1).
function kept(polygon: readonly Vector[], height: number, sign: 1 | -1): readonly Vector[] {
  if (polygon.every(([, y]) => sign * (y - height) >= 0)) return polygon;
  return polygon.flatMap((corner, i) => {
    const before = polygon[(i + polygon.length - 1) % polygon.length];
    const [is, was] = [sign * (corner[1] - height) >= 0, sign * (before[1] - height) >= 0];
    const pass = is === was ? [] : [passing(before, corner, height)];
    return is ? [...pass, corner] : pass;
  });
}

const CELLS = 64; // of a grid on each side, at the most
const MOST_CELLS = 256; // of a triangle: a larger one is looked at each time

/// Which triangles lie in cells of a grid in plan. `boxes`: of triangles: least x, y, z, then most.
class PlanGrid {
  private readonly cells: number[][];
  private readonly large: number[] = [];
  private readonly seen: Uint32Array;
  private turn = 0;
  private readonly side: number;
  private readonly least: Plan;
  private readonly scale: Plan;

  constructor(private readonly boxes: Float64Array, count: number) {
    this.seen = new Uint32Array(count);
    this.side = Math.min(CELLS, Math.max(1, Math.ceil(Math.sqrt(count))));
    this.cells = Array.from({ length: this.side ** 2 }, () => []);
    let [x, z, mostX, mostZ] = [Infinity, Infinity, -Infinity, -Infinity];
    for (let at = 0; at < 6 * count; at += 6) {
      [x, z] = [Math.min(x, boxes[at]), Math.min(z, boxes[at + 2])];
      [mostX, mostZ] = [Math.max(mostX, boxes[at + 3]), Math.max(mostZ, boxes[at + 5])];
    }
    this.least = { x, z };
    this.scale = { x: this.side / (mostX - x || 1), z: this.side / (mostZ - z || 1) };
    for (let i = 0; i < count; ++i) this.put(i);
  }

  /// Each once that touches a box in plan.
  visit(x0: number, z0: number, x1: number, z1: number, look: (triangle: number) => void): void {
    const { boxes, seen } = this;
    const turn = ++this.turn;
    const lookAt = (i: number): void => {
      if (seen[i] === turn) return;
      seen[i] = turn;
      const at = 6 * i;
      if (boxes[at] <= x1 && boxes[at + 3] >= x0 && boxes[at + 2] <= z1 && boxes[at + 5] >= z0) look(i);
    };
    this.large.forEach(lookAt);
    this.over(x0, z0, x1, z1, (cell) => { cell.forEach(lookAt); });
  }

  private put(i: number): void {
    const [x0, , z0, x1, , z1] = this.boxes.subarray(6 * i, 6 * i + 6);
    const cells: number[][] = [];
    this.over(x0, z0, x1, z1, (cell) => { cells.push(cell); });
    if (cells.length > MOST_CELLS) this.large.push(i);
    else for (const cell of cells) cell.push(i);
  }

  private over(x0: number, z0: number, x1: number, z1: number, look: (cell: number[]) => void): void {
    const cell = (value: number, axis: 'x' | 'z'): number => Math.min(Math.max(Math.floor((value - this.least[axis]) * this.scale[axis]), 0), this.side - 1);
    const [left, right] = [cell(x0, 'x'), cell(x1, 'x')];
    for (let row = cell(z0, 'z'); row <= cell(z1, 'z'); ++row) for (let column = left; column <= right; ++column) look(this.cells[row * this.side + column]);
  }
}

/// Triangles of the world around a place; y is up.
export class WalkSpace {
  private readonly boxes: Float64Array;
  private readonly grid: PlanGrid;

  /// `triangles`: nine numbers each.
  constructor(private readonly triangles: Float64Array) {
    const count = Math.floor(triangles.length / COORDINATES);
    this.boxes = new Float64Array(6 * count);
    for (let i = 0; i < count; ++i)
      for (let axis = 0; axis < 3; ++axis) {
        const [a, b, c] = [0, 1, 2].map((corner) => triangles[COORDINATES * i + 3 * corner + axis]);
        this.boxes[6 * i + axis] = Math.min(a, b, c);
        this.boxes[6 * i + 3 + axis] = Math.max(a, b, c);
      }
    this.grid = new PlanGrid(this.boxes, count);
  }

  /// What stands between two heights within `reach` of a place.
  obstacles({ x, z }: Plan, reach: number, low: number, high: number): Polygon[] {
    const found: Polygon[] = [];
    this.grid.visit(x - reach, z - reach, x + reach, z + reach, (i) => {
      if (this.boxes[6 * i + 1] >= high || this.boxes[6 * i + 4] <= low) return;
      const polygon = kept(kept(this.corners(i), low, 1), high, -1);
      if (polygon.length > 0) found.push(polygon.map(([px, , pz]) => [px, pz]));
    });
    return found;
  }

  /// The highest surface at a place that is not above `from`; -Infinity: there is none.
  ground({ x, z }: Plan, from: number): number {
    let best = -Infinity;
    this.grid.visit(x, z, x, z, (i) => {
      if (this.boxes[6 * i + 1] > from || this.boxes[6 * i + 4] <= best) return;
      const height = this.heightAt(i, x, z);
      if (height <= from && height > best) best = height;
    });
    return best;
  }

  private corners(triangle: number): Vector[] {
    const at = COORDINATES * triangle;
    const { triangles: t } = this;
    return [[t[at], t[at + 1], t[at + 2]], [t[at + 3], t[at + 4], t[at + 5]], [t[at + 6], t[at + 7], t[at + 8]]];
  }

  /// NaN: the triangle is not there, or upright.
  private heightAt(triangle: number, x: number, z: number): number {
    const [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = this.corners(triangle);
    const area = (bx - ax) * (cz - az) - (bz - az) * (cx - ax);
    const extent = Math.max(Math.abs(bx - ax), Math.abs(cx - ax), Math.abs(bz - az), Math.abs(cz - az));
    if (Math.abs(area) <= FLAT * extent * extent) return NaN;
    const u = ((bx - x) * (cz - z) - (bz - z) * (cx - x)) / area;
    const v = ((cx - x) * (az - z) - (cz - z) * (ax - x)) / area;
    const w = 1 - u - v;
    return Math.min(u, v, w) < -1e-9 ? NaN : u * ay + v * by + w * cy;
  }
}

function within(polygon: Polygon, { x, z }: Plan): boolean {
  let [left, right] = [false, false];
  polygon.forEach(([ax, az], i) => {
    const [bx, bz] = polygon[(i + 1) % polygon.length];
    const side = (bx - ax) * (z - az) - (bz - az) * (x - ax);
    if (side > 0) left = true;
    if (side < 0) right = true;
  });
  return polygon.length > 2 && left !== right;
}

/// The point of a polygon that is nearest to a place; the place itself if it is in it.
export function nearestOf(polygon: Polygon, place: Plan): Plan {
  if (within(polygon, place)) return place;
  let best: Plan = place;
  let least = Infinity;
  polygon.forEach(([ax, az], i) => {
    const [bx, bz] = polygon[(i + 1) % polygon.length];
    const [dx, dz] = [bx - ax, bz - az];
    const long = dx * dx + dz * dz;
    const t = long === 0 ? 0 : Math.min(Math.max(((place.x - ax) * dx + (place.z - az) * dz) / long, 0), 1);
    const point = { x: ax + t * dx, z: az + t * dz };
    const distance = Math.hypot(point.x - place.x, point.z - place.z);
    if (distance < least) [best, least] = [point, distance];
  });
  return best;
}

function side([ax, az]: readonly [number, number], [bx, bz]: readonly [number, number], { x, z }: Plan): number {
  return (bx - ax) * (z - az) - (bz - az) * (x - ax);
}

/// Tells whether the way from one place to another passes a side of a polygon.
export function passes(polygon: Polygon, from: Plan, to: Plan): boolean {
  const [start, end]: [number, number][] = [[from.x, from.z], [to.x, to.z]];
  return polygon.some((corner, i) => {
    const next = polygon[(i + 1) % polygon.length];
    const [a, b] = [{ x: corner[0], z: corner[1] }, { x: next[0], z: next[1] }];
    return side(corner, next, from) * side(corner, next, to) <= 0 && side(start, end, a) * side(start, end, b) <= 0
      && !(side(corner, next, from) === 0 && side(corner, next, to) === 0);
  });
}
