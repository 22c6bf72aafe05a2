// SPDX-License-Identifier: MIT
// Finds the points of a shape that are its outline, from wherever it is seen.
import type { Tile } from '../hierarchy/tile.js';

const DIRECTIONS = 256; // what lies between them sticks out by less than a hundredth of the size
const GOLDEN_ANGLE = Math.PI * (3 - Math.sqrt(5));

/// The vertices of triangles, or all own ones where there are none.
function shownVertices({ own, indices, interiorCount }: Pick<Tile, 'own' | 'indices' | 'interiorCount'>): number[] {
  const isShown = new Uint8Array(own);
  for (let i = 0; i < 3 * interiorCount; ++i) if (indices[i] < own) isShown[indices[i]] = 1;
  const all = Array.from({ length: own }, (_, vertex) => vertex);
  return interiorCount > 0 ? all.filter((vertex) => isShown[vertex] === 1) : all;
}

/// x, y, z of the farthest vertices in directions that are spread evenly; each once. O(256 vertices).
export function silhouetteOf(tile: Pick<Tile, 'own' | 'indices' | 'interiorCount' | 'positions'>): Float32Array {
  const { positions } = tile;
  const vertices = shownVertices(tile);
  const farthest = new Set<number>();
  for (let i = 0; i < DIRECTIONS; ++i) {
    const z = 1 - (2 * i + 1) / DIRECTIONS;
    const radius = Math.sqrt(1 - z * z);
    const [x, y] = [radius * Math.cos(GOLDEN_ANGLE * i), radius * Math.sin(GOLDEN_ANGLE * i)];
    let most = -Infinity;
    let best = -1;
    for (const vertex of vertices) {
      const along = x * positions[3 * vertex] + y * positions[3 * vertex + 1] + z * positions[3 * vertex + 2];
      if (along > most) [most, best] = [along, vertex];
    }
    if (best >= 0) farthest.add(best);
  }
  return Float32Array.from([...farthest].flatMap((vertex) => [...positions.subarray(3 * vertex, 3 * vertex + 3)]));
}
