// SPDX-License-Identifier: MIT
// Rays against boxes and triangles, in double precision. No ray passes between two triangles that share an edge
// (Woop, Benthin & Wald 2013, "Watertight ray/triangle intersection").
import { distanceOf, dot, scale, subtract, unit, type Vector } from './vectors.js';

export interface Ray {
  readonly from: Vector;
  /// Has any length but 0.
  readonly direction: Vector;
  /// The ray meets no triangle nearer than this; 0 if it is not given.
  readonly begin?: number;
  /// The ray meets only triangles that look at where it comes from, by the order of their corners.
  readonly meetsFronts?: boolean;
}

/// Looks for a place on triangles, and tells how near they may be.
export interface TriangleProbe {
  /// Each corner of the last triangle hit has this part of the point.
  readonly weights: Vector;
  /// Distance at which a box is entered, 0 inside; Infinity: it is missed. Six numbers from `at`: least, then most.
  enters(box: ArrayLike<number>, at?: number): number;
  entersSphere(center: Vector, radius: number): number;
  /// Distance at which a triangle is hit, and `weights`; Infinity: it is missed.
  hits(positions: ArrayLike<number>, a: number, b: number, c: number): number;
}

/// Exits are put off by what products round: a box is never missed for that.
const SLACK = 1e-15;

export class RayProbe implements TriangleProbe {
  /// Has length 1.
  readonly direction: Vector;
  /// Each corner of the last triangle hit has this part of the point.
  weights: Vector = [0, 0, 0];
  private readonly axes: readonly [number, number, number];
  private readonly shear: Vector;

  constructor(readonly ray: Ray) {
    this.direction = unit(ray.direction);
    const sizes = this.direction.map(Math.abs);
    const along = sizes.indexOf(Math.max(...sizes));
    this.axes = [(along + 1) % 3, (along + 2) % 3, along];
    const [x, y, z] = this.axes.map((axis) => this.direction[axis]);
    this.shear = [x / z, y / z, 1 / z];
  }

  /// Distance at which a box is entered, 0 inside; Infinity: it is missed. Six numbers from `at`: least, then most.
  enters(box: ArrayLike<number>, at = 0): number {
    const { from } = this.ray;
    let [entry, exit] = [0, Infinity];
    for (let axis = 0; axis < 3; ++axis) {
      const [least, most] = [box[at + axis] - from[axis], box[at + 3 + axis] - from[axis]];
      const way = this.direction[axis];
      if (way === 0) {
        if (!(least <= 0 && most >= 0)) return Infinity;
        continue;
      }
      entry = Math.max(entry, (way > 0 ? least : most) / way);
      exit = Math.min(exit, (way > 0 ? most : least) / way);
    }
    return entry <= exit + SLACK * Math.abs(exit) ? entry : Infinity;
  }

  /// Distance at which a sphere is entered, 0 inside; Infinity: it is missed.
  entersSphere(center: Vector, radius: number): number {
    const to = subtract(center, this.ray.from);
    const along = dot(to, this.direction);
    const aside = distanceOf(to, scale(this.direction, along));
    return aside > radius || along < -radius ? Infinity : Math.max(0, along - radius);
  }

  /// Distance at which a triangle is hit from a side that the ray meets, and `weights`; Infinity: it is missed.
  hits(positions: ArrayLike<number>, a: number, b: number, c: number): number {
    const [ax, ay, az] = this.sheared(positions, a);
    const [bx, by, bz] = this.sheared(positions, b);
    const [cx, cy, cz] = this.sheared(positions, c);
    const u = cx * by - cy * bx;
    const v = ax * cy - ay * cx;
    const w = bx * ay - by * ax;
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return Infinity;
    const sum = u + v + w;
    if (this.ray.meetsFronts === true && !(sum * this.shear[2] > 0)) return Infinity;
    const distance = (u * az + v * bz + w * cz) / sum;
    if (!(distance >= (this.ray.begin ?? 0))) return Infinity; // behind the eye, too near, or no area
    this.weights = [u / sum, v / sum, w / sum];
    return distance;
  }

  /// A vertex where the ray goes from 0 along the third axis.
  private sheared(positions: ArrayLike<number>, vertex: number): Vector {
    const { from } = this.ray;
    const [kx, ky, kz] = this.axes;
    const at = 3 * vertex;
    const z = positions[at + kz] - from[kz];
    return [positions[at + kx] - from[kx] - this.shear[0] * z, positions[at + ky] - from[ky] - this.shear[1] * z, this.shear[2] * z];
  }
}
