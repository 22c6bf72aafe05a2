// SPDX-License-Identifier: MIT
// Tells whether a point lies inside of a closed surface: its solid angle (van Oosterom & Strackee 1983).
import type { Tile } from '../hierarchy/tile.js';
import type { Vector } from './viewpoint.js';

/// How often the interior triangles of a tile go around a point: 0 outside, 1 inside of a closed surface. O(n).
export function windingNumber({ positions, indices, interiorCount }: Tile, [x, y, z]: Vector): number {
  let sum = 0;
  for (let t = 0; t < 3 * interiorCount; t += 3) {
    const [a, b, c] = [3 * indices[t], 3 * indices[t + 1], 3 * indices[t + 2]];
    const ax = positions[a] - x, ay = positions[a + 1] - y, az = positions[a + 2] - z;
    const bx = positions[b] - x, by = positions[b + 1] - y, bz = positions[b + 2] - z;
    const cx = positions[c] - x, cy = positions[c + 1] - y, cz = positions[c + 2] - z;
    const la = Math.sqrt(ax * ax + ay * ay + az * az);
    const lb = Math.sqrt(bx * bx + by * by + bz * bz);
    const lc = Math.sqrt(cx * cx + cy * cy + cz * cz);
    const volume = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
    const ab = ax * bx + ay * by + az * bz;
    const bc = bx * cx + by * cy + bz * cz;
    const ca = cx * ax + cy * ay + cz * az;
    sum += Math.atan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb);
  }
  return sum / (2 * Math.PI);
}
