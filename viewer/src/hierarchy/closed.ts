// SPDX-License-Identifier: MIT
import type { Indices } from './copies.js';

const SPAN = 65536; // above any vertex's number here

/// Tells whether each edge of the triangles is used as often in one direction as in the other. O(n log n).
export function isClosed(triangles: Indices): boolean {
  const edges = new Float64Array(triangles.length);
  for (let t = 0; t < triangles.length; t += 3)
    for (let corner = 0; corner < 3; ++corner) {
      const from = triangles[t + corner];
      const to = triangles[t + ((corner + 1) % 3)];
      // The direction is the lowest bit: both ways lie side by side when sorted.
      edges[t + corner] = 2 * (Math.min(from, to) * SPAN + Math.max(from, to)) + (from < to ? 0 : 1);
    }
  edges.sort();
  let balance = 0;
  for (let i = 0; i < edges.length; ++i) {
    balance += edges[i] % 2 === 0 ? 1 : -1;
    const ends = i + 1 === edges.length || Math.floor(edges[i] / 2) !== Math.floor(edges[i + 1] / 2);
    if (ends && balance !== 0) return false;
  }
  return triangles.length > 0;
}

/// Tells whether the triangles of a closed surface show their backs to the outside.
export function isInsideOut(positions: Float32Array, triangles: Indices): boolean {
  let volume = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const x = positions[b + 1] * positions[c + 2] - positions[b + 2] * positions[c + 1];
    const y = positions[b + 2] * positions[c] - positions[b] * positions[c + 2];
    const z = positions[b] * positions[c + 1] - positions[b + 1] * positions[c];
    volume += positions[a] * x + positions[a + 1] * y + positions[a + 2] * z;
  }
  return volume < 0;
}
