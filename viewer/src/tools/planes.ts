// SPDX-License-Identifier: MIT
// Planes that cut a model open: what lies behind any of them is cut away.
import { Matrix4, Plane, Vector3 } from 'three';
import type { Coordinates } from './coordinates.js';
import { dot, unit, type Vector } from './vectors.js';
import type { View } from '../view/view_table.js';

/// Kept is where normal · point + constant >= 0.
export interface CutPlane {
  /// Has length 1.
  readonly normal: Vector;
  readonly constant: number;
}

export function sideOf({ normal, constant }: CutPlane, point: Vector): number {
  return dot(normal, point) + constant;
}

export function planeThrough(point: Vector, normal: Vector): CutPlane {
  return { normal, constant: -dot(normal, point) };
}

const UNIT_ROUNDING = 1e-9; // of a normal's length: one that was rounded for a link stays as it is

/// A plane as views have it: a normal of any length, and a distance.
export function cutPlane([x, y, z, d]: readonly [number, number, number, number]): CutPlane {
  const long = Math.hypot(x, y, z);
  return Math.abs(long - 1) < UNIT_ROUNDING ? { normal: [x, y, z], constant: d } : { normal: unit([x, y, z]), constant: d / long };
}

export function flipped({ normal: [x, y, z], constant }: CutPlane): CutPlane {
  return { normal: [-x, -y, -z], constant: -constant };
}

/// Returns the six sides of a box: its inside is kept.
export function boxPlanes(min: Vector, max: Vector): CutPlane[] {
  const along = (axis: number, sign: number): Vector => [0, 1, 2].map((each) => (each === axis ? sign : 0)) as unknown as Vector;
  return [0, 1, 2].flatMap((axis) => [
    { normal: along(axis, 1), constant: -min[axis] },
    { normal: along(axis, -1), constant: max[axis] },
  ]);
}

/// The planes that a view cuts by, in the input's coordinates.
export function planesOf({ cut, box }: View): CutPlane[] {
  if (cut !== undefined) return [cutPlane(cut)];
  return box === undefined ? [] : boxPlanes([box[0], box[1], box[2]], [box[3], box[4], box[5]]);
}

/// Planes of the input's coordinates in the tiles'.
export function planesInTiles(planes: readonly CutPlane[], coordinates: Coordinates): CutPlane[] {
  const shift = coordinates.toInput([0, 0, 0]);
  return planes.map(({ normal, constant }) => ({ normal, constant: constant + dot(normal, shift) }));
}

/// In the world that `matrix` brings the plane's coordinates into.
export function worldPlane({ normal, constant }: CutPlane, matrix: Readonly<Matrix4>): Plane {
  return new Plane(new Vector3(...normal), constant).applyMatrix4(matrix);
}

/// Returns the normal of a plane across a direction of the world, in the coordinates that `matrix` brings into it.
export function localNormal(direction: Vector, { elements: e }: Readonly<Matrix4>): Vector {
  return unit([dot([e[0], e[1], e[2]], direction), dot([e[4], e[5], e[6]], direction), dot([e[8], e[9], e[10]], direction)]);
}
