// SPDX-License-Identifier: MIT
// The picture of a tile on the GPU.
import { LinearFilter, LinearMipmapLinearFilter, NoColorSpace, SRGBColorSpace, Texture } from 'three';
import { bitmapBytes, type Picture } from '../hierarchy/picture.js';
import type { Size } from '../hierarchy/picture_size.js';
import type { Tile } from '../hierarchy/tile.js';

/// Samples at the most where the surface is seen at a slant; a device may take fewer.
const ANISOTROPY = 4;

/// The root is never fetched again: its bitmap stays, and comes back from here if the device is lost.
function keepsBitmap(level: number): boolean {
  return level === 0;
}

/// Its bytes on the GPU, with smaller and smaller ones; before it is there, its bitmap takes less.
export function pictureMemory(size: Size, level: number): number {
  return Math.ceil((4 / 3) * bitmapBytes(size)) + (keepsBitmap(level) ? bitmapBytes(size) : 0);
}

/// Whether only the GPU has the tile's picture: it is lost with the device.
export function isOnlyOnGpu({ picture, normalMap }: Tile): boolean {
  return [picture, normalMap].some((each) => each !== null && each.bitmap.width === 0);
}

/// `content`: what its numbers are.
export function tileTexture({ bitmap }: Picture, level: number, content: 'colours' | 'directions' = 'colours'): Texture {
  const texture = new Texture(bitmap);
  texture.colorSpace = content === 'colours' ? SRGBColorSpace : NoColorSpace;
  texture.flipY = false;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.anisotropy = ANISOTROPY;
  if (!keepsBitmap(level)) texture.onUpdate = () => { bitmap.close(); };
  texture.needsUpdate = true;
  return texture;
}
