// SPDX-License-Identifier: MIT
// The triangles of the original mesh, partition by partition: they are asked for, looked at, and let go, a few at once.
import { placeOf, type Indices } from '../hierarchy/copies.js';
import { letGo } from '../hierarchy/let_go.js';
import type { Tile } from '../hierarchy/tile.js';
import type { TileRecord } from '../hierarchy/tile_index.js';
import type { Omits } from '../scene/omission.js';
import type { TileSource } from '../scene/surface.js';
import { partitionsOf } from './partitions.js';
import { shownCorners } from './shown_triangles.js';
import type { Triangles } from './volume.js';

export interface OriginalOptions {
  readonly signal: AbortSignal;
  /// What is left out; null: nothing is.
  readonly omits?: Omits | null;
  /// Is told how many of the partitions are done.
  readonly progress?: (done: number, all: number) => void;
}

const AT_ONCE = 4;

/// Lists border triangles: the first of the tiles at one counts it.
function borderOf(tile: Tile, omits: Omits | null): Triangles {
  const { border, own, ghosts, neighbours, ghostStarts, index } = tile;
  const owners = new Uint32Array(ghosts);
  neighbours.forEach((neighbour, i) => owners.fill(neighbour, ghostStarts[i], ghostStarts[i + 1]));
  const isOwn = (vertex: number): boolean => {
    const place = placeOf(tile, vertex);
    return place < own || owners[place - own] > index;
  };
  const corners: number[] = [];
  for (let i = 0; i < border.length; i += 3) if ([0, 1, 2].every((k) => isOwn(border[i + k]))) corners.push(border[i], border[i + 1], border[i + 2]);
  return trianglesOf(tile, Uint32Array.from(corners), omits);
}

function trianglesOf(tile: Tile, all: Indices, omits: Omits | null): Triangles {
  const corners = shownCorners(tile, all, omits);
  return { positions: tile.positions, corners, count: corners.length / 3 };
}

/// Each triangle of a partition is in one of `parts` of one partition.
export type LookAt<Found> = (parts: readonly Triangles[], record: TileRecord) => Found;

/// What was found in each of the partitions that are wanted, in their order, whatever comes first. Rejects where a file cannot be had, and when the
/// signal aborts.
export async function lookAtOriginal<Found>(source: TileSource, wanted: (record: TileRecord) => boolean, look: LookAt<Found>, options: OriginalOptions): Promise<Found[]> {
  const { signal, progress, omits = null } = options;
  const partitions = await partitionsOf(source, wanted, signal);
  const found = new Array<Found>(partitions.length);
  let [next, done] = [0, 0];
  const work = async (): Promise<void> => {
    while (next < partitions.length) {
      const i = next++;
      const { node, record } = partitions[i];
      const tile = await source.load(node, record, signal);
      found[i] = look([trianglesOf(tile, tile.indices.subarray(0, 3 * tile.interiorCount), omits), borderOf(tile, omits)], record);
      letGo(tile);
      signal.throwIfAborted();
      progress?.(++done, partitions.length);
    }
  };
  await Promise.all(Array.from({ length: AT_ONCE }, work));
  return found;
}
