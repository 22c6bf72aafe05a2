// SPDX-License-Identifier: MIT
// Pictures that stay compressed on the GPU.
import { CompressedTexture, RGBA_S3TC_DXT5_Format, RGB_ETC2_Format, type Texture } from 'three';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Seam } from '../src/cut/seam.js';
import { transcode } from '../src/hierarchy/basis.js';
import { chooseFormat, type DeviceFormats, type TexelFormat } from '../src/hierarchy/device_formats.js';
import { isDropped, type Picture } from '../src/hierarchy/picture.js';
import { pictureSize } from '../src/hierarchy/picture_size.js';
import { partsOf, readTile, type Tile } from '../src/hierarchy/tile.js';
import { Tree } from '../src/hierarchy/tree.js';
import { memoryOf, mostMemory, texelBytesOf, vertexBytesOf } from '../src/scene/tile_object.js';
import { isOnlyOnGpu, tileTexture } from '../src/scene/tile_texture.js';
import { KTX2_ALPHA, KTX2_OPAQUE } from './support/ktx2.js';
import { tileBytes, type TileParts } from './support/tile_bytes.js';

const SIZE = { width: 16, height: 8 };
const NONE: DeviceFormats = { etc2: false, s3tc: false, bptc: false, astc: false };
const DESKTOP: DeviceFormats = { ...NONE, s3tc: true, bptc: true };
const PHONE: DeviceFormats = { ...NONE, etc2: true, astc: true };
const ETC2_NAME = 'WEBGL_compressed_texture_etc';

function tile(file: Uint8Array<ArrayBuffer>, alphaMode = 'OPAQUE', level = 1): TileParts {
  return {
    level, index: 0, own: 3,
    positions: [1, 2, 0, 0, 2, 0, 5, 5, 5],
    texcoords: [0.25, 0.25, 0.75, 0.75, 0, 1],
    picture: { ...SIZE, file, mimeType: 'image/ktx2', alphaMode, unlit: true },
    interior: [0, 1, 2],
  };
}

async function read(parts: TileParts): Promise<Tile> {
  return readTile(tileBytes(parts), 'tile.glb', null);
}

describe('chooseFormat', () => {
  it.each<[string, DeviceFormats, boolean, boolean, TexelFormat]>([
    ['a phone, ETC1S', PHONE, true, false, 'etc2'],
    ['a phone, ETC1S with alpha', PHONE, true, true, 'etc2_alpha'],
    ['a phone, UASTC', PHONE, false, false, 'astc'],
    ['a desktop, ETC1S', DESKTOP, true, false, 'bc1'],
    ['a desktop, ETC1S with alpha', DESKTOP, true, true, 'bc3'],
    ['a desktop, UASTC', DESKTOP, false, true, 'bc7'],
    ['one with ETC2 alone, UASTC', { ...NONE, etc2: true }, false, true, 'etc2_alpha'],
    ['one with BPTC alone, ETC1S', { ...NONE, bptc: true }, true, false, 'bc7'],
    ['one that knows no blocks', NONE, true, true, 'rgba'],
  ])('of %s', (_, device, isEtc1s, hasAlpha, format) => {
    expect(chooseFormat(device, isEtc1s, hasAlpha)).toBe(format);
  });
});

describe('pictureSize', () => {
  it('knows KTX2 by its mark, and sides that are multiples of 4', () => {
    expect(pictureSize(KTX2_OPAQUE, 'image/ktx2')).toEqual(SIZE);
    expect(pictureSize(KTX2_OPAQUE, 'image/png')).toBeNull();
    expect(pictureSize(KTX2_OPAQUE.subarray(0, 27), 'image/ktx2')).toBeNull();
    const odd = KTX2_OPAQUE.slice();
    odd[20] = 15;
    expect(pictureSize(odd, 'image/ktx2')).toBeNull();
  });
});

describe('transcode', () => {
  it('gives all smaller pictures, in blocks of 8 or 16 bytes', async () => {
    const etc2 = await transcode(KTX2_OPAQUE, SIZE, PHONE);
    expect(etc2?.format).toBe('etc2');
    expect(etc2?.levels.map(({ width, height, data }) => [width, height, data.length])).toEqual([[16, 8, 64], [8, 4, 16], [4, 2, 8], [2, 1, 8], [1, 1, 8]]);
    const bc3 = await transcode(KTX2_ALPHA, SIZE, DESKTOP);
    expect(bc3?.format).toBe('bc3');
    expect(bc3?.levels.map(({ data }) => data.length)).toEqual([128, 32, 16, 16, 16]);
  });

  it('gives plain texels to a device without blocks', async () => {
    const plain = await transcode(KTX2_ALPHA, SIZE, NONE);
    expect(plain?.format).toBe('rgba');
    const { data } = plain!.levels[0];
    expect(data.length).toBe(4 * 16 * 8);
    for (const [i, value] of [200, 120, 40, 255].entries()) expect(Math.abs(data[i] - value)).toBeLessThanOrEqual(8);
    expect(data[4 * 15 + 3]).toBeLessThanOrEqual(8);
  });

  it.each([['is cut', (bytes: Uint8Array) => bytes.subarray(0, 300)], ['says another size', (bytes: Uint8Array) => { const other = bytes.slice(); other[20] = 32; return other; }]])('is null of what %s', async (_, change) => {
    expect(await transcode(change(KTX2_OPAQUE), SIZE, PHONE)).toBeNull();
    expect(await transcode(KTX2_OPAQUE, SIZE, PHONE)).not.toBeNull();
  });
});

describe('tiles with KTX2', () => {
  beforeEach(() => {
    vi.stubGlobal('OffscreenCanvas', class {
      getContext(): object {
        return { getSupportedExtensions: () => [ETC2_NAME, 'WEBGL_compressed_texture_s3tc'], getExtension: () => null };
      }
    });
  });
  afterEach(() => {
    vi.unstubAllGlobals();
  });

  it('have texels as the device keeps them, and hand them over', async () => {
    const opaque = await read(tile(KTX2_OPAQUE));
    const texels = opaque.picture!.texels as Extract<Picture['texels'], { levels: unknown }>;
    expect(texels.format).toBe('etc2');
    expect(partsOf(opaque)).toEqual(expect.arrayContaining(texels.levels.map(({ data }) => data.buffer)));
    expect((await read(tile(KTX2_ALPHA, 'MASK'))).picture).toMatchObject({ alpha: 'MASK', texels: { format: 'etc2_alpha' } });
  });

  it('are a texture that is never made smaller again, and whose bytes are let go but for the root', async () => {
    for (const level of [0, 1]) {
      const made = await read(tile(KTX2_OPAQUE, 'OPAQUE', level));
      const texture: Texture = tileTexture(made.picture!, level);
      expect(texture).toBeInstanceOf(CompressedTexture);
      expect(texture).toMatchObject({ format: RGB_ETC2_Format, generateMipmaps: false, flipY: false });
      expect(texture.mipmaps).toHaveLength(5);
      expect(isOnlyOnGpu(made)).toBe(false);
      texture.onUpdate?.(texture);
      expect([isOnlyOnGpu(made), isDropped(made.picture!)]).toEqual([level > 0, level > 0]);
    }
    const alpha = { ...(await read(tile(KTX2_ALPHA, 'BLEND'))).picture!, texels: (await transcode(KTX2_ALPHA, SIZE, DESKTOP))! };
    expect(tileTexture(alpha, 1).format).toBe(RGBA_S3TC_DXT5_Format);
  });

  it('take an eighth of the memory of others, before they come and when they are there', async () => {
    const made = await read(tile(KTX2_OPAQUE));
    const ofPicture = memoryOf(made, new Seam(made, new Tree(4)), false) - memoryOf({ ...made, picture: null }, new Seam(made, new Tree(4)), false);
    expect(ofPicture).toBe(Math.ceil((4 / 3) * 0.5 * 16 * 8));
    const record = { own: 3, ghosts: 0, copies: 0, splits: 0, interior: 1, border: 0, pictureWidth: 16, pictureHeight: 8, hasNormalMap: false };
    const most = (plain: number): number => mostMemory(record, { level: 1, vertexBytes: vertexBytesOf(made), wires: false, texelBytes: { plain, mapped: 0 } });
    expect(texelBytesOf(made)).toEqual({ plain: 0.5, mapped: 4.5 });
    expect(most(4) - most(0.5)).toBe(Math.ceil((4 / 3) * 4 * 16 * 8) - ofPicture);
  });

  it('are refused with a picture that is broken', async () => {
    const broken = KTX2_OPAQUE.slice();
    broken.fill(255, 80, 100);
    await expect(read(tile(broken))).rejects.toThrow('its picture is broken');
  });
});
