// Vertices at one place: its first has the place's number, the others, its copies, come behind all places.
import type { Indices } from './tile.js';

/// The first copy of the first place from `place` on; `copyOf`: the places of copies, ascending. O(log n).
export function firstCopy(copyOf: Indices, place: number): number {
  let low = 0;
  let high = copyOf.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (copyOf[middle] < place) low = middle + 1;
    else high = middle;
  }
  return low;
}

/// Where a vertex is; `places`: their number.
export function placeOf(vertex: number, places: number, copyOf: Indices): number {
  return vertex < places ? vertex : copyOf[vertex - places];
}

/// Triangles of places.
export function toPlaces(triangles: Indices, places: number, copyOf: Indices): Indices {
  return copyOf.length === 0 ? triangles : triangles.map((vertex) => placeOf(vertex, places, copyOf));
}
