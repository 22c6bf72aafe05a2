// SPDX-License-Identifier: MIT
// Tools may know this of a view: the triangles that it draws, and where finer ones come from.
import type { Sphere } from 'three';
import type { Directory } from '../hierarchy/remote_hierarchy.js';
import type { Tile } from '../hierarchy/tile.js';
import type { TileRecord } from '../hierarchy/tile_index.js';
import type { Node } from '../hierarchy/tree.js';

/// A tile that is drawn: the first `triangles` of its `tile.indices`, of which the interior ones never change. It holds until the next `update`.
export interface DrawnTile {
  readonly node: Node;
  readonly tile: Tile;
  readonly triangles: number;
  /// Around all of them, in the tiles' coordinates.
  readonly sphere: Sphere;
}

export interface TileSource extends Directory {
  /// Fetches a tile as it is in its file: whoever asks owns it, and lets go of its picture. Rejects with HierarchyProblem, and with the reason of `signal`.
  load(node: Node, record: TileRecord, signal: AbortSignal): Promise<Tile>;
}
