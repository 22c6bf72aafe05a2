// SPDX-License-Identifier: MIT
// The volume of the original mesh: its partitions are asked for, measured, and let go, one behind the other.
import type { TileRecord } from '../hierarchy/tile_index.js';
import type { TileSource } from '../scene/surface.js';
import { lookAtOriginal, type OriginalOptions } from './original_triangles.js';
import { sideOf, type CutPlane } from './planes.js';
import type { Vector } from './vectors.js';
import { cutsOf, partOfVolume, sumOf, type Volume } from './volume.js';

export type OriginalVolumeOptions = OriginalOptions;

function isCutAway({ min, max }: TileRecord, plane: CutPlane): boolean {
  const corner = plane.normal.map((part, axis) => (part > 0 ? max[axis] : min[axis])) as unknown as Vector;
  return sideOf(plane, corner) < 0;
}

/// `planes`: as for volumeOf(). Its bound is 0 but for what rounding did when the hierarchy was made. The same sum whatever comes first. Rejects where a
/// file cannot be had, and when the signal aborts.
export async function originalVolume(source: TileSource, planes: readonly CutPlane[], options: OriginalVolumeOptions): Promise<Volume> {
  const cuts = cutsOf(planes);
  const volumes = await lookAtOriginal(source, (record) => !cuts.some((plane) => isCutAway(record, plane)), (parts, { bound }) =>
    sumOf(parts.map((triangles) => partOfVolume(triangles, planes, bound))), options);
  return sumOf(volumes);
}
