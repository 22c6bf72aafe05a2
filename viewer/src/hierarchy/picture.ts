// SPDX-License-Identifier: MIT
// The picture of a tile (docs/file_format.md, section 4.10).
import type { Glb } from './glb.js';
import { texelBytes, transcode, type CompressedTexels } from './basis.js';
import { FORMATS } from './formats.js';
import { KTX2, pictureSize, type Size } from './picture_size.js';

export type Alpha = 'OPAQUE' | 'MASK' | 'BLEND';

export interface Picture extends Size {
  /// Its upper left corner is (0, 0) of the tile's texture coordinates; sRGB, alpha not multiplied in. As soon as it is on the GPU,
  /// a bitmap is closed and has no size of its own, and compressed texels are let go: see tile_texture.ts.
  readonly texels: ImageBitmap | CompressedTexels;
  readonly alpha: Alpha;
  /// The colours have their light already.
  readonly unlit: boolean;
}

/// As it is in the file.
interface StoredPicture extends Omit<Picture, 'texels'> {
  readonly type: string;
  readonly bytes: Uint8Array;
}

export const BITMAP_TEXEL_BYTES = 4;
const TITLES = FORMATS.pictures.map(({ title }) => title);
const ALPHAS: readonly Alpha[] = ['OPAQUE', 'MASK', 'BLEND'];

export function isCompressed(texels: Picture['texels']): texels is CompressedTexels {
  return 'levels' in texels;
}

/// Bytes of a texel on the GPU.
export function bytesOfTexel({ texels }: Picture): number {
  return isCompressed(texels) ? texelBytes(texels.format) : BITMAP_TEXEL_BYTES;
}

/// Returns what a picture holds besides the GPU's copy.
export function partsOfPicture({ texels }: Picture): Transferable[] {
  return isCompressed(texels) ? texels.levels.map(({ data }) => data.buffer) : [texels];
}

/// Lets go of what the GPU has a copy of.
export function dropPicture({ texels }: Picture): void {
  if (isCompressed(texels)) texels.levels.length = 0;
  else texels.close();
}

/// True once it was let go.
export function isDropped({ texels }: Picture): boolean {
  return isCompressed(texels) ? texels.levels.length === 0 : texels.width === 0;
}

/// Bytes of its file, at the most: no coder makes more of noise than a little above what it is.
export function mostPictureBytes(size: Size): number {
  return size.width > 0 ? 5 * size.width * size.height + 65536 : 0;
}

/// `number`: of its buffer view; `size`: that the file must say, for whoever decodes it makes room for as much.
export function findPicture(glb: Glb, number: number, size: Size): StoredPicture {
  const type = String(glb.gltf.images?.find(({ bufferView }) => bufferView === number)?.mimeType);
  const material = glb.gltf.materials?.[0];
  const bytes = glb.file(number);
  const found = pictureSize(bytes, type);
  if (found === null) glb.fail(`its picture is no ${TITLES.slice(0, -1).join(', ')} or ${TITLES.at(-1)}`);
  if (found.width !== size.width || found.height !== size.height) glb.fail('its picture has another size than it says');
  const alpha = ALPHAS.find((each) => each === (material?.alphaMode ?? 'OPAQUE')) ?? glb.fail('its picture has an alpha mode that is not known');
  const unlit = material?.extensions?.KHR_materials_unlit !== undefined;
  return { ...size, type, bytes, alpha, unlit };
}

export const NOT_DECODED = 'its picture cannot be decoded';

async function decodeBitmap({ type, bytes, width, height }: StoredPicture): Promise<ImageBitmap | null> {
  const bitmap = await createImageBitmap(new Blob([bytes.slice()], { type }), { imageOrientation: 'none', premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
  if (bitmap.width === width && bitmap.height === height) return bitmap;
  bitmap.close();
  return null;
}

/// Where this is called: it takes a while.
export async function decodePicture(glb: Glb, stored: StoredPicture): Promise<Picture> {
  const { alpha, unlit, width, height } = stored;
  let texels: Picture['texels'] | null;
  try {
    texels = await (stored.type === KTX2 ? transcode(stored.bytes, stored) : decodeBitmap(stored));
  } catch {
    return glb.fail(NOT_DECODED);
  }
  if (texels === null) return glb.fail(stored.type === KTX2 ? 'its picture is broken' : 'its picture has another size than it says');
  return { width, height, texels, alpha, unlit };
}
