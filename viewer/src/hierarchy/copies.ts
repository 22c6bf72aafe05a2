// SPDX-License-Identifier: MIT
// Vertices at one place: its first has the place's number. Behind all places come further vertices of places, copies,
// and behind those splits: vertices once more, with another normal.

/// Numbers of vertices.
export type Indices = Uint16Array | Uint32Array;

/// A tile has these.
export interface TilePlaces {
  readonly own: number;
  readonly ghosts: number;
  /// The place of each copy, own or ghost; ascending.
  readonly copyOf: Indices;
  /// The vertex of each split, a place or a copy; ascending.
  readonly splitOf: Indices;
}

/// Where values from `value` on begin; `ascending`: copyOf or splitOf. O(log n).
export function firstOf(ascending: Indices, value: number): number {
  let low = 0;
  let high = ascending.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (ascending[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

/// The number of vertices that are no splits.
export function unsplitOf({ own, ghosts, copyOf }: TilePlaces): number {
  return own + ghosts + copyOf.length;
}

function addWithSplits(of: TilePlaces, vertex: number, to: number[]): void {
  const { splitOf } = of;
  to.push(vertex);
  for (let split = firstOf(splitOf, vertex); splitOf[split] === vertex; ++split) to.push(unsplitOf(of) + split);
}

/// The place's first, then its copies, each with its splits behind it.
export function verticesAt(of: TilePlaces, place: number): readonly number[] {
  const { own, ghosts, copyOf } = of;
  const vertices: number[] = [];
  addWithSplits(of, place, vertices);
  for (let copy = firstOf(copyOf, place); copyOf[copy] === place; ++copy) addWithSplits(of, own + ghosts + copy, vertices);
  return vertices;
}

/// Returns the place of a vertex.
export function placeOf(of: TilePlaces, vertex: number): number {
  const places = of.own + of.ghosts;
  const unsplit = unsplitOf(of);
  const whole = vertex < unsplit ? vertex : of.splitOf[vertex - unsplit];
  return whole < places ? whole : of.copyOf[whole - places];
}

/// Returns triangles with places for corners.
export function toPlaces(of: TilePlaces, triangles: Indices): Indices {
  const isPlain = of.copyOf.length === 0 && of.splitOf.length === 0;
  return isPlain ? triangles : triangles.map((vertex) => placeOf(of, vertex));
}
