// SPDX-License-Identifier: MIT
// The picture of a tile on the GPU.
import {
  CompressedTexture, DataTexture, LinearFilter, LinearMipmapLinearFilter, NoColorSpace, RGB_ETC2_Format, RGB_S3TC_DXT1_Format, RGBA_ASTC_4x4_Format, RGBA_BPTC_Format,
  RGBA_ETC2_EAC_Format, RGBA_S3TC_DXT5_Format, SRGBColorSpace, Texture,
} from 'three';
import type { CompressedPixelFormat } from 'three';
import type { CompressedTexels } from '../hierarchy/basis.js';
import type { TexelFormat } from '../hierarchy/device_formats.js';
import { bytesOfTexel, dropPicture, isCompressed, isDropped, type Picture } from '../hierarchy/picture.js';
import type { Size } from '../hierarchy/picture_size.js';
import type { Tile } from '../hierarchy/tile.js';

/// Samples at the most where the surface is seen at a slant; a device may take fewer.
const ANISOTROPY = 4;

const FORMATS: Readonly<Record<Exclude<TexelFormat, 'rgba'>, CompressedPixelFormat>> = {
  etc2: RGB_ETC2_Format,
  etc2_alpha: RGBA_ETC2_EAC_Format,
  bc1: RGB_S3TC_DXT1_Format,
  bc3: RGBA_S3TC_DXT5_Format,
  bc7: RGBA_BPTC_Format,
  astc: RGBA_ASTC_4x4_Format,
};

/// The root is never fetched again: its picture stays, and comes back from here if the device is lost.
function keepsPicture(level: number): boolean {
  return level === 0;
}

/// Bytes on the GPU, with smaller and smaller ones, of a picture of so many bytes a texel; before it is there it takes less, or as much.
export function pictureMemory({ width, height }: Size, texelBytes: number, level: number): number {
  const bytes = texelBytes * width * height;
  return Math.ceil((4 / 3) * bytes) + (keepsPicture(level) ? bytes : 0);
}

/// The same of one that is there.
export function memoryOfPicture(picture: Picture, level: number): number {
  return pictureMemory(picture, bytesOfTexel(picture), level);
}

/// Tells whether only the GPU has the tile's picture: it is lost with the device.
export function isOnlyOnGpu({ picture, normalMap }: Tile): boolean {
  return [picture, normalMap].some((each) => each !== null && isDropped(each));
}

function compressedTexture({ format, levels }: CompressedTexels): Texture {
  const [{ data, width, height }] = levels;
  if (format !== 'rgba') return new CompressedTexture([...levels], width, height, FORMATS[format]);
  const texture = new DataTexture(data, width, height);
  texture.mipmaps = [...levels];
  return texture;
}

/// Makes the texture of a picture; `content`: its numbers are these.
export function tileTexture(picture: Picture, level: number, content: 'colours' | 'directions' = 'colours'): Texture {
  const { texels } = picture;
  const texture = isCompressed(texels) ? compressedTexture(texels) : new Texture(texels);
  texture.colorSpace = content === 'colours' ? SRGBColorSpace : NoColorSpace;
  texture.flipY = false;
  texture.generateMipmaps = !isCompressed(texels);
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.anisotropy = ANISOTROPY;
  if (!keepsPicture(level))
    texture.onUpdate = () => {
      dropPicture(picture);
      if (!isCompressed(texels)) return;
      texture.mipmaps = [];
      texture.image = { width: picture.width, height: picture.height };
    };
  texture.needsUpdate = true;
  return texture;
}
