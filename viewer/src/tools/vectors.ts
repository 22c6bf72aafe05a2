// SPDX-License-Identifier: MIT
// Points and directions in double precision.
import type { Vector } from '../cut/viewpoint.js';

export type { Vector };

export function subtract(a: Vector, b: Vector): Vector {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

export function add(a: Vector, b: Vector): Vector {
  return [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
}

export function scale(a: Vector, factor: number): Vector {
  return [a[0] * factor, a[1] * factor, a[2] * factor];
}

export function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

export function cross(a: Vector, b: Vector): Vector {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

export function length(a: Vector): number {
  return Math.hypot(a[0], a[1], a[2]);
}

export function distanceOf(a: Vector, b: Vector): number {
  return length(subtract(a, b));
}

/// Returns the vector at length 1; (0, 0, 0) stays so.
export function unit(a: Vector): Vector {
  const long = length(a);
  return long > 0 ? scale(a, 1 / long) : [0, 0, 0];
}

/// A vertex of an array of x, y, z.
export function vertexAt(positions: ArrayLike<number>, vertex: number): Vector {
  return [positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]];
}

/// x, y, z of each of some points, one after another.
export function triplesOf(numbers: readonly number[]): Vector[] {
  return Array.from({ length: Math.floor(numbers.length / 3) }, (_, i) => vertexAt(numbers, i));
}
