// The picture of a tile on the GPU.
import { LinearFilter, LinearMipmapLinearFilter, SRGBColorSpace, Texture } from 'three';
import { bitmapBytes, type Picture } from '../hierarchy/picture.js';
import type { Size } from '../hierarchy/picture_size.js';

/// Samples at the most where the surface is seen at a slant; a device may take fewer.
const ANISOTROPY = 4;

/// Its bytes: the bitmap, which comes back from here if the device is lost, and on the GPU the same with smaller and smaller ones.
export function pictureMemory(size: Size): number {
  return bitmapBytes(size) + Math.ceil((4 / 3) * bitmapBytes(size));
}

export function tileTexture({ bitmap }: Picture): Texture {
  const texture = new Texture(bitmap);
  texture.colorSpace = SRGBColorSpace;
  texture.flipY = false;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.anisotropy = ANISOTROPY;
  texture.needsUpdate = true;
  return texture;
}
