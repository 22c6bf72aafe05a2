// SPDX-License-Identifier: MIT
// The picture of a tile (docs/file_format.md, section 4.10).
import type { Glb } from './glb.js';
import { pictureSize, type Size } from './picture_size.js';

export type Alpha = 'OPAQUE' | 'MASK' | 'BLEND';

export interface Picture extends Size {
  /// Its upper left corner is (0, 0) of the tile's texture coordinates; sRGB, alpha not multiplied in. Closed, and without a size of
  /// its own, as soon as it is on the GPU: see tile_texture.ts.
  readonly bitmap: ImageBitmap;
  readonly alpha: Alpha;
  /// The colours have their light already.
  readonly unlit: boolean;
}

/// As it is in the file.
interface StoredPicture extends Omit<Picture, 'bitmap'> {
  readonly file: Blob;
}

const ALPHAS: readonly Alpha[] = ['OPAQUE', 'MASK', 'BLEND'];

/// Bytes of a decoded picture, four channels.
export function bitmapBytes({ width, height }: Size): number {
  return 4 * width * height;
}

/// Bytes of its file, at the most: no coder makes more of noise than a little above what it is.
export function mostPictureBytes(size: Size): number {
  return size.width > 0 ? 5 * size.width * size.height + 65536 : 0;
}

/// `number`: of its buffer view; `size`: that the file must say, for whoever decodes it makes room for as much.
export function findPicture(glb: Glb, number: number, size: Size): StoredPicture | null {
  if (size.width === 0) return null;
  const type = String(glb.gltf.images?.[0]?.mimeType);
  const material = glb.gltf.materials?.[0];
  const bytes = glb.file(number);
  const found = pictureSize(bytes, type);
  if (found === null) glb.fail('its picture is no JPEG, PNG or WebP');
  if (found.width !== size.width || found.height !== size.height) glb.fail('its picture has another size than it says');
  const alpha = ALPHAS.find((each) => each === (material?.alphaMode ?? 'OPAQUE')) ?? glb.fail('its picture has an alpha mode that is not known');
  const unlit = material?.extensions?.KHR_materials_unlit !== undefined;
  return { ...size, file: new Blob([bytes.slice()], { type }), alpha, unlit };
}

export const NOT_DECODED = 'its picture cannot be decoded';

/// Where this is called: it takes a while.
export async function decodePicture(glb: Glb, { file, alpha, unlit, width, height }: StoredPicture): Promise<Picture> {
  let bitmap: ImageBitmap;
  try {
    bitmap = await createImageBitmap(file, { imageOrientation: 'none', premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
  } catch {
    return glb.fail(NOT_DECODED);
  }
  if (bitmap.width === width && bitmap.height === height) return { width, height, bitmap, alpha, unlit };
  bitmap.close();
  return glb.fail('its picture has another size than it says');
}
