// SPDX-License-Identifier: MIT
// The place of a surface that is nearest to a point, in double precision (Ericson 2005, "Real-Time Collision Detection", 5.1.5).
import type { TriangleProbe } from './ray.js';
import { add, distanceOf, dot, scale, subtract, vertexAt, type Vector } from './vectors.js';

/// Parts of three corners that make up the point of a triangle that is nearest to `point`.
function nearestWeights(point: Vector, a: Vector, b: Vector, c: Vector): Vector {
  const [ab, ac] = [subtract(b, a), subtract(c, a)];
  const [d1, d2] = [dot(ab, subtract(point, a)), dot(ac, subtract(point, a))];
  if (d1 <= 0 && d2 <= 0) return [1, 0, 0];
  const [d3, d4] = [dot(ab, subtract(point, b)), dot(ac, subtract(point, b))];
  if (d3 >= 0 && d4 <= d3) return [0, 1, 0];
  const inC = d1 * d4 - d3 * d2;
  if (inC <= 0 && d1 >= 0 && d3 <= 0) return [1 - d1 / (d1 - d3), d1 / (d1 - d3), 0];
  const [d5, d6] = [dot(ab, subtract(point, c)), dot(ac, subtract(point, c))];
  if (d6 >= 0 && d5 <= d6) return [0, 0, 1];
  const inB = d5 * d2 - d1 * d6;
  if (inB <= 0 && d2 >= 0 && d6 <= 0) return [1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)];
  const inA = d3 * d6 - d5 * d4;
  const along = (d4 - d3) / (d4 - d3 + (d5 - d6));
  if (inA <= 0 && d4 >= d3 && d5 >= d6) return [0, 1 - along, along];
  const sum = inA + inB + inC;
  return [inA / sum, inB / sum, inC / sum];
}

export class PointProbe implements TriangleProbe {
  weights: Vector = [0, 0, 0];

  constructor(private readonly point: Vector) {}

  enters(box: ArrayLike<number>, at = 0): number {
    const away = this.point.map((value, axis) => Math.max(box[at + axis] - value, 0, value - box[at + 3 + axis]));
    return Math.hypot(...away);
  }

  entersSphere(center: Vector, radius: number): number {
    return Math.max(0, distanceOf(center, this.point) - radius);
  }

  hits(positions: ArrayLike<number>, a: number, b: number, c: number): number {
    const corners = [vertexAt(positions, a), vertexAt(positions, b), vertexAt(positions, c)] as const;
    const weights = nearestWeights(this.point, ...corners);
    const distance = distanceOf(this.point, corners.map((corner, k) => scale(corner, weights[k])).reduce(add));
    if (!Number.isFinite(distance)) return Infinity; // a triangle without area
    this.weights = weights;
    return distance;
  }
}
