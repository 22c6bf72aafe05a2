// SPDX-License-Identifier: MIT
// Lengths along points of the input.
import { add, distanceOf, dot, scale, subtract, type Vector } from './vectors.js';

export interface Measures {
  /// Of each part, from point to point.
  readonly parts: readonly number[];
  readonly length: number;
  /// Of the line's plan: as seen from above.
  readonly level: number;
  /// From the first point to the last: straight, in plan, and up.
  readonly straight: number;
  readonly straightLevel: number;
  readonly rise: number;
}

/// `up`: of length 1, as `HierarchyView.upwards`.
export function measuresOf(points: readonly Vector[], up: Vector): Measures {
  const riseOf = (a: Vector, b: Vector): number => dot(subtract(b, a), up);
  const levelOf = (a: Vector, b: Vector): number => distanceOf(b, add(a, scale(up, riseOf(a, b))));
  const pairs = points.slice(1).map((point, i) => [points[i], point] as const);
  const parts = pairs.map(([a, b]) => distanceOf(a, b));
  const sum = (values: readonly number[]): number => values.reduce((total, value) => total + value, 0);
  const [first, last] = [points[0] ?? [0, 0, 0], points[points.length - 1] ?? [0, 0, 0]];
  return {
    parts,
    length: sum(parts),
    level: sum(pairs.map(([a, b]) => levelOf(a, b))),
    straight: distanceOf(first, last),
    straightLevel: levelOf(first, last),
    rise: riseOf(first, last),
  };
}
