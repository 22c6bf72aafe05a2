// SPDX-License-Identifier: MIT
// Where a mesh is looked at from: what of a tile is in view, and how large its error is there.
import type { Cone } from '../hierarchy/normals.js';

export type Vector = readonly [number, number, number];

export interface Viewpoint {
  readonly eye: Vector;
  /// Inside is where x * a + y * b + z * c + d >= 0, of each plane; (a, b, c) of unit length.
  readonly planes: readonly (readonly [number, number, number, number])[];
  /// Pixels that one unit takes at distance 1; at all distances where rays are parallel.
  readonly pixels: number;
  /// Nothing closer is drawn; above 0.
  readonly near: number;
  /// How many times longer a length along each axis is seen than along the one that is seen shortest: 1 or more.
  readonly stretch: Vector;
  /// Where rays are parallel: how much nearer to the viewer one unit along each axis leads, as it is seen; of length 1 where nothing is
  /// stretched. Without it they meet in the eye.
  readonly towards?: Vector;
}

export interface Box {
  readonly min: Vector;
  readonly max: Vector;
}

/// Tells whether a part of the box may be in view.
export function isInView({ planes }: Viewpoint, { min, max }: Box): boolean {
  return planes.every(([a, b, c, d]) => {
    const x = a > 0 ? max[0] : min[0];
    const y = b > 0 ? max[1] : min[1];
    const z = c > 0 ? max[2] : min[2];
    return a * x + b * y + c * z + d >= 0;
  });
}

/// Tells whether all points are in view; `points`: x, y, z of each.
export function areInView({ planes }: Viewpoint, points: ArrayLike<number>): boolean {
  return planes.every(([a, b, c, d]) => {
    for (let i = 0; i < points.length; i += 3) if (a * points[i] + b * points[i + 1] + c * points[i + 2] + d < 0) return false;
    return true;
  });
}

/// From the plane across parallel rays that has the eye to the box's nearest corner; less than 0 behind it.
function depthAlong(towards: Vector, eye: Vector, { min, max }: Box): number {
  return towards.reduce((sum, part, axis) => sum + part * eye[axis] - Math.max(part * min[axis], part * max[axis]), 0);
}

/// From the eye to the box, as it is seen; 0 inside.
export function distance({ eye, stretch, towards }: Viewpoint, box: Box): number {
  if (towards !== undefined) return Math.max(depthAlong(towards, eye, box), 0);
  const { min, max } = box;
  let squared = 0;
  for (let axis = 0; axis < 3; ++axis) {
    const outside = stretch[axis] * Math.max(min[axis] - eye[axis], 0, eye[axis] - max[axis]);
    squared += outside * outside;
  }
  return Math.sqrt(squared);
}

/// Pixels that a length in the box takes, at most, along the axis that is seen shortest.
function leastPixels(view: Viewpoint, box: Box, length: number): number {
  if (view.towards !== undefined) return length * view.pixels;
  return (length * view.pixels) / Math.max(distance(view, box), view.near);
}

/// Tells whether parallel rays come to the box from outside: nothing of it is nearer than what is drawn.
export function comesFromOutside({ eye, near, towards }: Viewpoint, box: Box): boolean {
  return towards !== undefined && depthAlong(towards, eye, box) >= near;
}

/// Pixels that a length in the box takes, at most.
export function pixelsOf(view: Viewpoint, box: Box, length: number): number {
  return Math.max(...view.stretch) * leastPixels(view, box, length);
}

/// Pixels along the side of a square, if `squares` of them make up a surface as large as half the box's sides together: it is as
/// large if it lies along the axes, and nearly if it is round.
export function squarePixels(view: Viewpoint, box: Box, squares: number): number {
  const [a, b, c] = box.max.map((max, axis) => view.stretch[axis] * (max - box.min[axis]));
  return leastPixels(view, box, Math.sqrt((a * b + b * c + c * a) / squares));
}

/// Tells whether all directions of the cone look away from the eye, from anywhere in the box, by `margin` radians more
/// than they must. Of what is stretched nobody knows.
export function looksAway({ eye, stretch, towards }: Viewpoint, { min, max }: Box, { axis, cosine }: Cone, margin: number): boolean {
  if (cosine <= 0 || Math.max(...stretch) > 1) return false;
  const to = towards ?? [0, 1, 2].map((k) => eye[k] - (min[k] + max[k]) / 2);
  const radius = towards === undefined ? Math.hypot(max[0] - min[0], max[1] - min[1], max[2] - min[2]) / 2 : 0;
  const far = Math.hypot(to[0], to[1], to[2]);
  if (far <= radius) return false;
  const slack = Math.acos(cosine) + Math.asin(radius / far) + margin;
  if (slack >= Math.PI / 2) return false;
  return (axis[0] * to[0] + axis[1] * to[1] + axis[2] * to[2]) / far < -Math.sin(slack);
}
