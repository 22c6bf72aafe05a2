// SPDX-License-Identifier: MIT
// Values of a tile's vertices as attributes for shaders: all of them are one buffer, however many are looked at.
import { DynamicDrawUsage, InterleavedBuffer, InterleavedBufferAttribute, type BufferGeometry } from 'three';
import { valueWidth } from '../hierarchy/scalar_values.js';
import type { Tile } from '../hierarchy/tile.js';

/// Gives the geometry of a tile the value at that place of its vertices. Requires that it has values.
export function setValueAttribute(geometry: BufferGeometry, tile: Tile, name: string, index: number): void {
  const known = geometry.attributes[name] as InterleavedBufferAttribute | undefined;
  if (known?.offset === index) return;
  const values = Object.values(geometry.attributes).find((each) => each instanceof InterleavedBufferAttribute)?.data
    ?? new InterleavedBuffer(tile.values!, valueWidth(tile)).setUsage(DynamicDrawUsage);
  geometry.setAttribute(name, new InterleavedBufferAttribute(values, 1, index));
}
