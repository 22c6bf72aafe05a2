// SPDX-License-Identifier: MIT
import { valueWidth } from '../hierarchy/scalar_values.js';
import type { PickedTile } from './pick.js';

/// All values of a vertex.
export function valuesAt(tile: PickedTile, vertex: number): number[] {
  const width = valueWidth(tile);
  return Array.from((tile.values ?? new Float32Array(0)).subarray(width * vertex, width * (vertex + 1)));
}
