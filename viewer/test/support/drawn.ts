// SPDX-License-Identifier: MIT
// Triangles as if a view drew them.
import { Box3, Sphere, Vector3 } from 'three';
import type { DrawnTile } from '../../src/index.js';

/// `corners`: three a triangle, of vertices x, y, z.
export function drawnTile(positions: readonly number[], corners: readonly number[]): DrawnTile {
  const points = Array.from({ length: positions.length / 3 }, (_, v) => new Vector3(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]));
  const tile = { positions: Float32Array.from(positions), indices: Uint16Array.from(corners), interiorCount: corners.length / 3 };
  return { node: { level: 0, index: 0 }, tile: tile as DrawnTile['tile'], triangles: corners.length / 3, sphere: new Box3().setFromPoints(points).getBoundingSphere(new Sphere()) };
}

/// A cube of two units from `at`: its twelve triangles show their fronts to the outside.
export function cube([x, y, z]: readonly [number, number, number] = [0, 0, 0]): DrawnTile {
  const positions = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((bits) => [x + 2 * (bits & 1), y + (bits & 2), z + (bits & 4) / 2]);
  const corners = [0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5];
  return drawnTile(positions, corners);
}
