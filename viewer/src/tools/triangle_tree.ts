// SPDX-License-Identifier: MIT
// Boxes over the triangles of a tile: a ray looks at few of them. Triangles are in the order of a Morton curve, and
// each box holds two halves of a run of it (Lauterbach et al. 2009, "Fast BVH construction on GPUs").
import type { Indices } from '../hierarchy/copies.js';
import type { TriangleProbe } from './ray.js';

const RUN = 8; // triangles of the lowest boxes
const GRID = 512; // cells of the curve on each axis: 27 bits
const TRIANGLES = 2 ** 26; // at the most: 26 bits more, exact in a double
const FLOATS = 6; // of a box

/// Nine bits, each two places from the next.
function spread(cell: number): number {
  let bits = cell;
  bits = (bits | (bits << 16)) & 0x030000ff;
  bits = (bits | (bits << 8)) & 0x0300f00f;
  bits = (bits | (bits << 4)) & 0x030c30c3;
  return (bits | (bits << 2)) & 0x09249249;
}

function emptyBoxes(count: number): Float32Array {
  return Float32Array.from({ length: FLOATS * count }, (_, i) => (i % FLOATS < 3 ? Infinity : -Infinity));
}

/// Widens a box by three numbers from `low` on, and three from `high` on.
function widen(boxes: Float32Array, box: number, from: ArrayLike<number>, low: number, high: number): void {
  for (let axis = 0; axis < 3; ++axis) {
    const at = FLOATS * box + axis;
    boxes[at] = Math.min(boxes[at], from[low + axis]);
    boxes[at + 3] = Math.max(boxes[at + 3], from[high + axis]);
  }
}

export class TriangleTree {
  private readonly order: Uint32Array;
  private readonly boxes: Float32Array;
  private readonly firstRun: number;

  /// Holds the first `count` triangles; positions and corners must stay as they are.
  constructor(
    private readonly positions: Float32Array,
    private readonly corners: Indices,
    readonly count: number,
  ) {
    this.order = this.sorted();
    const runs = 2 ** Math.ceil(Math.log2(Math.max(1, Math.ceil(count / RUN))));
    this.firstRun = runs - 1;
    this.boxes = emptyBoxes(2 * runs - 1);
    this.fill();
  }

  get bytes(): number {
    return this.order.byteLength + this.boxes.byteLength;
  }

  private sorted(): Uint32Array {
    const all = emptyBoxes(1);
    for (let corner = 0; corner < 3 * this.count; ++corner) widen(all, 0, this.positions, 3 * this.corners[corner], 3 * this.corners[corner]);
    const keys = Float64Array.from({ length: this.count }, (_, triangle) => this.curve(triangle, all) * TRIANGLES + triangle);
    return Uint32Array.from(keys.sort(), (key) => key % TRIANGLES);
  }

  private curve(triangle: number, all: Float32Array): number {
    let place = 0;
    for (let axis = 0; axis < 3; ++axis) {
      const size = all[axis + 3] - all[axis];
      let sum = 0;
      for (let k = 0; k < 3; ++k) sum += this.positions[3 * this.corners[3 * triangle + k] + axis] - all[axis];
      const cell = size > 0 ? Math.min(GRID - 1, Math.floor((sum / 3 / size) * GRID)) : 0;
      place += spread(cell) * 2 ** axis;
    }
    return place;
  }

  private fill(): void {
    this.order.forEach((triangle, i) => {
      for (let k = 0; k < 3; ++k) {
        const vertex = 3 * this.corners[3 * triangle + k];
        widen(this.boxes, this.firstRun + Math.floor(i / RUN), this.positions, vertex, vertex);
      }
    });
    for (let box = this.boxes.length / FLOATS - 1; box > 0; --box)
      widen(this.boxes, (box - 1) >> 1, this.boxes, FLOATS * box, FLOATS * box + 3);
  }

  /// Calls for triangles that may be hit nearer than the limit, near boxes first; what it returns is the new limit.
  visit(probe: TriangleProbe, limit: number, look: (triangle: number) => number): void {
    const waiting = [0];
    for (let box = waiting.pop(); box !== undefined; box = waiting.pop()) {
      if (!(probe.enters(this.boxes, FLOATS * box) < limit)) continue;
      if (box >= this.firstRun) limit = this.visitRun(box - this.firstRun, limit, look);
      else waiting.push(...this.farFirst(probe, box));
    }
  }

  /// Calls for triangles that may touch a box: six numbers, least, then most.
  visitBox(box: ArrayLike<number>, look: (triangle: number) => void): void {
    const waiting = [0];
    const touches = (each: number): boolean => [0, 1, 2].every((axis) => this.boxes[FLOATS * each + axis] <= box[axis + 3] && this.boxes[FLOATS * each + axis + 3] >= box[axis]);
    for (let each = waiting.pop(); each !== undefined; each = waiting.pop()) {
      if (!touches(each)) continue;
      if (each < this.firstRun) waiting.push(2 * each + 1, 2 * each + 2);
      else this.visitRun(each - this.firstRun, 0, (triangle) => { look(triangle); return 0; });
    }
  }

  private farFirst(probe: TriangleProbe, box: number): [number, number] {
    const [one, other] = [2 * box + 1, 2 * box + 2];
    return probe.enters(this.boxes, FLOATS * one) < probe.enters(this.boxes, FLOATS * other) ? [other, one] : [one, other];
  }

  private visitRun(run: number, limit: number, look: (triangle: number) => number): number {
    const end = Math.min(this.count, RUN * (run + 1));
    for (let i = RUN * run; i < end; ++i) limit = look(this.order[i]);
    return limit;
  }
}
