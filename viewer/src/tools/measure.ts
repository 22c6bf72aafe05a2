// SPDX-License-Identifier: MIT
// Lengths, angles and areas along points of the input, and how far off they may be where the points may be.
import { add, cross, distanceOf, dot, length as lengthOf, scale, subtract, type Vector } from './vectors.js';

export interface Measures {
  /// The length of each part, from point to point.
  readonly parts: readonly number[];
  readonly length: number;
  /// The length of the line's plan, as seen from above.
  readonly level: number;
  /// From the first point to the last: straight, in plan, and up.
  readonly straight: number;
  readonly straightLevel: number;
  readonly rise: number;
  /// Between the last two parts, radians; null: there are fewer, or one is 0 long.
  readonly angle: number | null;
  /// The area of the polygon through all points and back to the first, and of its plan: of one that is not flat, as seen from where it is
  /// largest. Null: there are fewer than three points.
  readonly area: number | null;
  readonly areaLevel: number | null;
}

const ROUNDING = 1e-12;
const sum = (values: readonly number[]): number => values.reduce((total, value) => total + value, 0);

function angleOf([a, b, c]: readonly Vector[]): number | null {
  const [one, other] = [subtract(a, b), subtract(c, b)];
  if (lengthOf(one) === 0 || lengthOf(other) === 0) return null;
  return Math.atan2(lengthOf(cross(one, other)), dot(one, other));
}

/// Twice the polygon's area, along its normal. Relative to the first point: far from the origin products would lose their digits.
function doubledArea(points: readonly Vector[]): Vector {
  const spokes = points.slice(1).map((point) => subtract(point, points[0]));
  return spokes.slice(1).map((spoke, i) => cross(spokes[i], spoke)).reduce(add, [0, 0, 0]);
}

/// A part is upright where it has a plan of more than rounding leaves.
function planOf(doubled: Vector, up: Vector): number {
  const along = Math.abs(dot(doubled, up));
  return along > ROUNDING * lengthOf(doubled) ? along / 2 : 0;
}

/// `up`: of length 1, as `HierarchyView.upwards`.
export function measuresOf(points: readonly Vector[], up: Vector): Measures {
  const riseOf = (a: Vector, b: Vector): number => dot(subtract(b, a), up);
  const levelOf = (a: Vector, b: Vector): number => distanceOf(b, add(a, scale(up, riseOf(a, b))));
  const pairs = points.slice(1).map((point, i) => [points[i], point] as const);
  const parts = pairs.map(([a, b]) => distanceOf(a, b));
  const [first, last] = [points[0] ?? [0, 0, 0], points[points.length - 1] ?? [0, 0, 0]];
  const isPolygon = points.length > 2;
  const doubled = isPolygon ? doubledArea(points) : null;
  return {
    parts,
    length: sum(parts),
    level: sum(pairs.map(([a, b]) => levelOf(a, b))),
    straight: distanceOf(first, last),
    straightLevel: levelOf(first, last),
    rise: riseOf(first, last),
    angle: isPolygon ? angleOf(points.slice(-3)) : null,
    area: doubled && lengthOf(doubled) / 2,
    areaLevel: doubled && planOf(doubled, up),
  };
}

/// How far the direction from one point to another may turn.
function turnOf(a: Vector, b: Vector, errors: number): number {
  const distance = distanceOf(a, b);
  return distance > errors ? Math.asin(errors / distance) : Math.PI;
}

/// By how much each of the measures may be off, at the most, where each point may be `errors` away from where it is. Not less.
export function boundsOf(points: readonly Vector[], errors: readonly number[]): Measures {
  const parts = errors.slice(1).map((error, i) => errors[i] + error);
  const [length, ends] = [sum(parts), (errors[0] ?? 0) + (errors[errors.length - 1] ?? 0)];
  const count = points.length;
  const isPolygon = count > 2;
  // A point that is off moves the area by half of what lies between its neighbours; two that are off by half of both.
  const area = sum(points.map((_, i) => {
    const [before, after] = [(i + count - 1) % count, (i + 1) % count];
    return (errors[i] * distanceOf(points[before], points[after]) + errors[i] * errors[after]) / 2;
  }));
  const [a, b, c] = points.slice(-3);
  const angle = isPolygon ? Math.min(Math.PI, turnOf(a, b, errors[count - 3] + errors[count - 2]) + turnOf(b, c, errors[count - 2] + errors[count - 1])) : null;
  return { parts, length, level: length, straight: ends, straightLevel: ends, rise: ends, angle, area: isPolygon ? area : null, areaLevel: isPolygon ? area : null };
}
