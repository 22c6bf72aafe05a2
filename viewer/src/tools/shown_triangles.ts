// SPDX-License-Identifier: MIT
// Tools that measure see what is drawn, without what plug-ins leave out.
import type { Indices } from '../hierarchy/copies.js';
import type { Tile } from '../hierarchy/tile.js';
import type { Omits } from '../scene/omission.js';
import type { DrawnTile } from '../scene/surface.js';

/// The corners of triangles of a tile, three each, without those that are left out. `omits`: null: none is.
export function shownCorners(tile: Tile, corners: Indices, omits: Omits | null): Indices {
  return omits === null ? corners : corners.filter((_, i) => !omits(tile, corners[i - (i % 3)]));
}

/// What is drawn of a view. O(drawn triangles) where something is left out.
export function shownSurface({ surface, omits }: { readonly surface: readonly DrawnTile[]; readonly omits: Omits | null }): readonly DrawnTile[] {
  if (omits === null) return surface;
  return surface.map((drawn) => {
    const indices = shownCorners(drawn.tile, drawn.tile.indices.subarray(0, 3 * drawn.triangles), omits);
    return { ...drawn, tile: { ...drawn.tile, indices }, triangles: indices.length / 3 };
  });
}
