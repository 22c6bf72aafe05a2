// SPDX-License-Identifier: MIT
// Normals of meshes that have none, and the cone that holds nearly all of a tile's.
import type { Indices } from './copies.js';

/// Directions around an axis: those with dot(direction, axis) >= cosine.
export interface Cone {
  readonly axis: readonly [number, number, number];
  readonly cosine: number;
}

const BINS = 64;
const OUTSIDE_SHARE = 0.01; // of the area: a scan has some triangles that are turned by noise

/// Calls `use` with each triangle's corners and its normal, as long as twice its area.
function eachNormal(
  positions: Float32Array,
  triangles: Indices,
  use: (a: number, b: number, c: number, x: number, y: number, z: number) => void,
): void {
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t];
    const b = 3 * triangles[t + 1];
    const c = 3 * triangles[t + 2];
    const ux = positions[b] - positions[a];
    const uy = positions[b + 1] - positions[a + 1];
    const uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a];
    const vy = positions[c + 1] - positions[a + 1];
    const vz = positions[c + 2] - positions[a + 2];
    use(a, b, c, uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
  }
}

/// The mean of the triangles around each vertex, weighted by area: x, y, z, 0 in parts of 32767; of a
/// vertex without area around it, z.
export function vertexNormals(positions: Float32Array, ...lists: Indices[]): Int16Array {
  const sums = new Float64Array(positions.length);
  for (const triangles of lists)
    eachNormal(positions, triangles, (a, b, c, x, y, z) => {
      for (const corner of [a, b, c]) {
        sums[corner] += x;
        sums[corner + 1] += y;
        sums[corner + 2] += z;
      }
    });
  const normals = new Int16Array((positions.length / 3) * 4);
  for (let i = 0, n = 0; i < sums.length; i += 3, n += 4) {
    const length = Math.hypot(sums[i], sums[i + 1], sums[i + 2]);
    if (!(length > 0 && length < Infinity)) normals[n + 2] = 32767;
    else for (let axis = 0; axis < 3; ++axis) normals[n + axis] = Math.round((32767 * sums[i + axis]) / length);
  }
  return normals;
}

/// Returns the cone of all triangles but those with a hundredth of the area. A cosine of -1 says nothing about directions.
export function normalCone(positions: Float32Array, ...lists: Indices[]): Cone {
  const axis: [number, number, number] = [0, 0, 0];
  for (const triangles of lists)
    eachNormal(positions, triangles, (_a, _b, _c, x, y, z) => {
      axis[0] += x;
      axis[1] += y;
      axis[2] += z;
    });
  const length = Math.hypot(...axis);
  if (!(length > 0 && length < Infinity)) return { axis: [0, 0, 1], cosine: -1 };
  for (let i = 0; i < 3; ++i) axis[i] /= length;
  return { axis, cosine: cosineOf(axis, positions, lists) };
}

/// The largest of the bins' lower ends below which lies no more than the share that may.
function cosineOf(axis: readonly number[], positions: Float32Array, lists: Indices[]): number {
  const areas = new Float64Array(BINS + 1);
  let total = 0;
  for (const triangles of lists)
    eachNormal(positions, triangles, (_a, _b, _c, x, y, z) => {
      const area = Math.hypot(x, y, z);
      if (area === 0) return;
      const cosine = (axis[0] * x + axis[1] * y + axis[2] * z) / area;
      areas[Math.max(0, Math.floor(((cosine + 1) / 2) * BINS))] += area;
      total += area;
    });
  let below = 0;
  for (let bin = 0; bin < BINS; ++bin) {
    below += areas[bin];
    if (below > OUTSIDE_SHARE * total) return (2 * bin) / BINS - 1;
  }
  return 1 - 2 / BINS;
}
