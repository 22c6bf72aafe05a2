// SPDX-License-Identifier: MIT
// How far a shown point may be from the input.
import { keyOf, type Node } from '../hierarchy/tree.js';
import type { DrawnTile, TileSource } from '../scene/surface.js';

/// Returns the bound in a tile's record; Infinity: it is not known.
export function recordedBound(source: TileSource | null, node: Node): number {
  return source?.index.record(node)?.bound ?? Infinity;
}

/// Returns the bound of a point on a tile that is drawn: the tile's own; and as its border triangles may have corners of others, those of all tiles that it may
/// touch. `boundOf`: of a tile's record; Infinity: not known. Infinity if the tile is not drawn.
export function shownBound(node: Node, surface: readonly DrawnTile[], boundOf: (node: Node) => number): number {
  const key = keyOf(node.level, node.index);
  const own = surface.find(({ node: other }) => keyOf(other.level, other.index) === key);
  if (own === undefined) return Infinity;
  return Math.max(...surface.filter(({ sphere }) => sphere.intersectsSphere(own.sphere)).map((drawn) => boundOf(drawn.node)));
}
