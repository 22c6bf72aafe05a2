// SPDX-License-Identifier: MIT
import { valueWidth } from '../hierarchy/scalar_values.js';
import type { Tile } from '../hierarchy/tile.js';

/// A tile is looked at for these.
export type PickedTile = Pick<Tile, 'positions'> & Partial<Pick<Tile, 'values'>>;

/// All values of a vertex.
export function valuesAt(tile: PickedTile, vertex: number): number[] {
  const width = valueWidth(tile);
  return Array.from((tile.values ?? new Float32Array(0)).subarray(width * vertex, width * (vertex + 1)));
}
