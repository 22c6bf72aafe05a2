// SPDX-License-Identifier: MIT
// The volume of the original mesh: its partitions are asked for, measured, and let go, one behind the other.
import { placeOf, type Indices } from '../hierarchy/copies.js';
import { letGo, type Tile } from '../hierarchy/tile.js';
import type { TileRecord } from '../hierarchy/tile_index.js';
import type { Omits } from '../scene/omission.js';
import type { TileSource } from '../scene/surface.js';
import { partitionsOf, type Recorded } from './partitions.js';
import { sideOf, type CutPlane } from './planes.js';
import type { Vector } from './vectors.js';
import { shownCorners } from './shown_triangles.js';
import { cutsOf, partOfVolume, sumOf, type Triangles, type Volume } from './volume.js';

export interface OriginalVolumeOptions {
  readonly signal: AbortSignal;
  /// What is left out; null: nothing is.
  readonly omits?: Omits | null;
  /// Is told how many of the partitions are measured.
  readonly progress?: (done: number, all: number) => void;
}

const AT_ONCE = 4;

function isCutAway({ min, max }: TileRecord, plane: CutPlane): boolean {
  const corner = plane.normal.map((part, axis) => (part > 0 ? max[axis] : min[axis])) as unknown as Vector;
  return sideOf(plane, corner) < 0;
}

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

async function measured(source: TileSource, { node, record }: Recorded, planes: readonly CutPlane[], { signal, omits = null }: OriginalVolumeOptions): Promise<Volume> {
  const tile = await source.load(node, record, signal);
  const interior = trianglesOf(tile, tile.indices.subarray(0, 3 * tile.interiorCount), omits);
  const parts = [interior, borderOf(tile, omits)].map((triangles) => partOfVolume(triangles, planes, record.bound));
  letGo(tile);
  return sumOf(parts);
}

/// `planes`: as for volumeOf(). Its bound is 0 but for what rounding did when the hierarchy was made. The same sum whatever comes first. Rejects where a
/// file cannot be had, and when the signal aborts.
export async function originalVolume(source: TileSource, planes: readonly CutPlane[], options: OriginalVolumeOptions): Promise<Volume> {
  const { signal, progress } = options;
  const cuts = cutsOf(planes);
  const partitions = await partitionsOf(source, (record) => !cuts.some((plane) => isCutAway(record, plane)), signal);
  const volumes = new Array<Volume>(partitions.length);
  let [next, done] = [0, 0];
  const work = async (): Promise<void> => {
    while (next < partitions.length) {
      const i = next++;
      volumes[i] = await measured(source, partitions[i], planes, options);
      signal.throwIfAborted();
      progress?.(++done, partitions.length);
    }
  };
  await Promise.all(Array.from({ length: AT_ONCE }, work));
  return sumOf(volumes);
}
