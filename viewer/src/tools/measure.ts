// Lengths along points of the input.
import { distanceOf, subtract, type Vector } from './vectors.js';

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

/// `heightAxis`: 1 or 2, the one that points up.
export function measuresOf(points: readonly Vector[], heightAxis: 1 | 2): Measures {
  const levelOf = (a: Vector, b: Vector): number => Math.hypot(...subtract(a, b).filter((_, axis) => axis !== heightAxis));
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
    rise: last[heightAxis] - first[heightAxis],
  };
}
