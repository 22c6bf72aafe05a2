// SPDX-License-Identifier: MIT
// Tiles with pictures.
import { dropPicture } from '../src/hierarchy/picture.js';
import { MeshBasicMaterial, MeshMatcapMaterial, MeshStandardMaterial, SRGBColorSpace, type Texture } from 'three';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Seam } from '../src/cut/seam.js';
import { TileStore } from '../src/cut/tile_store.js';
import { HierarchyProblem } from '../src/hierarchy/problem.js';
import { partsOf, readTile, type Tile } from '../src/hierarchy/tile.js';
import type { ExpectedCounts } from '../src/hierarchy/tile_counts.js';
import { Tree, keyOf } from '../src/hierarchy/tree.js';
import { sharedMaterials } from '../src/scene/materials.js';
import { DEFAULT_LOOK, type Look } from '../src/scene/settings.js';
import { TileObject, memoryOf, mostMemory, vertexBytesOf } from '../src/scene/tile_object.js';
import { FakeBitmap, jpeg, png } from './support/pictures.js';
import { packedTileBytes, tileBytes, type PictureParts, type TileParts } from './support/tile_bytes.js';

const PICTURE: PictureParts = { file: jpeg(64, 32), mimeType: 'image/jpeg', width: 64, height: 32, unlit: true };

/// Two triangles, the second of which is elsewhere in the picture: vertices 0 and 1 have splits, 4 and 5.
const SQUARE: TileParts = {
  own: 4,
  splitOf: [0, 1],
  positions: [0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0],
  colours: Array.from({ length: 6 }, () => [255, 0, 0, 255]).flat(),
  texcoords: [0, 0, 0.5, 0, 0, 0.5, 1, 1, 0.75, 0.5, 1, 0.5],
  picture: PICTURE,
  interior: [0, 1, 2, 4, 3, 5],
};

/// Two boundary vertices, two ghosts of tile 2/1; the first has a split.
const FINE: TileParts = {
  level: 2, index: 2, own: 2, ghosts: 2,
  splitOf: [2],
  positions: [0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 1, 0],
  texcoords: [0, 0, 0.5, 0, 0, 0.5, 0.5, 0.5, 1, 1],
  picture: PICTURE,
  interior: [],
  border: [0, 1, 2, 1, 3, 4],
  neighbours: [1], ghostStarts: [0, 2], chains: [0, 1, 1, 0],
};

const COARSE: TileParts = {
  level: 1, index: 0, own: 3,
  positions: [1, 2, 0, 0, 2, 0, 5, 5, 5],
  texcoords: [0.25, 0.25, 0.75, 0.75, 0, 1],
  picture: PICTURE,
  interior: [0, 1, 2],
};

async function read(parts: TileParts, change: Record<string, number> = {}, expected: ExpectedCounts | null = null): Promise<Tile> {
  return readTile(tileBytes(parts, change), 'tile.glb', expected);
}

const decode = vi.fn<(file: Blob, options?: ImageBitmapOptions) => Promise<FakeBitmap>>(async () => Promise.resolve(new FakeBitmap(64, 32)));

beforeEach(() => {
  FakeBitmap.open = 0;
  decode.mockClear();
  vi.stubGlobal('createImageBitmap', decode);
});
afterEach(() => {
  vi.unstubAllGlobals();
});

describe('readTile', () => {
  it('reads texture coordinates, of splits too, and decodes the picture as it is', async () => {
    const tile = await read(SQUARE);
    expect([...tile.texcoords!]).toEqual(SQUARE.texcoords);
    expect(tile.picture).toMatchObject({ alpha: 'OPAQUE', unlit: true, texels: { width: 64, height: 32 } });
    const [file, options] = decode.mock.calls[0];
    expect(new Uint8Array(await file.arrayBuffer())).toEqual(PICTURE.file);
    expect(file.type).toBe('image/jpeg');
    expect(options).toEqual({ imageOrientation: 'none', premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
  });

  it('reads the same of a compressed tile', async () => {
    expect(await readTile(await packedTileBytes(SQUARE), 'tile.glb', null)).toEqual(await read(SQUARE));
  });

  it('keeps the colours of a textured mesh', async () => {
    expect([...(await read(SQUARE)).colours!.subarray(0, 4)]).toEqual([255, 0, 0, 255]);
  });

  it('gives splits the normal of their place where it makes normals', async () => {
    const { normals, normalsFrom } = await read(SQUARE);
    expect(normalsFrom).toBe('viewer');
    for (const [split, vertex] of [[4, 0], [5, 1]]) expect([...normals.subarray(4 * split, 4 * split + 4)]).toEqual([...normals.subarray(4 * vertex, 4 * vertex + 4)]);
    expect(normals[2]).not.toBe(0);
  });

  it.each(['MASK', 'BLEND'])('knows alpha mode %s', async (alphaMode) => {
    const picture = { ...PICTURE, alphaMode, file: png(64, 32), mimeType: 'image/png', unlit: false };
    expect((await read({ ...SQUARE, picture })).picture).toMatchObject({ alpha: alphaMode, unlit: false });
  });

  it('hands the bitmap over with the arrays', async () => {
    const tile = await read(SQUARE);
    expect(partsOf(tile)).toContain(tile.picture!.texels);
    expect(partsOf(tile)).toContain(tile.texcoords!.buffer);
  });

  const up = Array.from({ length: 6 }, () => [0, 0, 1]).flat();
  it.each<[string, Partial<TileParts>, Record<string, number>, string]>([
    ['a picture without coordinates', { texcoords: undefined }, {}, 'a picture without texture coordinates'],
    ['fewer coordinates than vertices', { texcoords: SQUARE.texcoords!.slice(2) }, {}, 'has not the 48 bytes'],
    ['a coordinate outside', { texcoords: [1.01, ...SQUARE.texcoords!.slice(1)] }, {}, 'outside the picture'],
    ['a coordinate that is no number', { texcoords: [NaN, ...SQUARE.texcoords!.slice(1)] }, {}, 'outside the picture'],
    ['splits without a picture', { picture: undefined }, {}, 'splits without computed normals or a picture'],
    ['a split of another given normal', { normals: up.map((value, i) => (i === 16 ? 1 : value)) }, {}, 'differs from its vertex'],
    ['a picture of one side', {}, { imageHeight: 0 }, 'one side only'],
    ['a picture larger than any', {}, { imageWidth: 8193 }, '"imageWidth" is not from 0 to 8192'],
    ['a picture that is not there', {}, { image: -1 }, 'section -1 is no file'],
    ['a picture of another section', {}, { image: 0 }, 'its picture is no JPEG, PNG, WebP or KTX2'],
    ['a picture of another type than it says', { picture: { ...PICTURE, mimeType: 'image/png' } }, {}, 'its picture is no JPEG, PNG, WebP or KTX2'],
    ['a picture of another kind', { picture: { ...PICTURE, mimeType: 'image/svg+xml' } }, {}, 'its picture is no JPEG, PNG, WebP or KTX2'],
    ['a picture of another size', { picture: { ...PICTURE, file: jpeg(64, 33) } }, {}, 'has another size'],
    ['an unknown alpha mode', { picture: { ...PICTURE, alphaMode: 'GLOW' } }, {}, 'alpha mode that is not known'],
  ])('refuses %s, before it is decoded', async (_, parts, change, problem) => {
    const refused = read({ ...SQUARE, ...parts }, change);
    await expect(refused).rejects.toBeInstanceOf(HierarchyProblem);
    await expect(refused).rejects.toThrow(problem);
    expect(decode).not.toHaveBeenCalled();
  });

  it('refuses a picture that cannot be decoded', async () => {
    decode.mockRejectedValueOnce(new DOMException('no', 'InvalidStateError'));
    await expect(read(SQUARE)).rejects.toThrow(new HierarchyProblem('tile.glb', 'its picture cannot be decoded'));
  });

  it('closes a picture that turns out to have another size', async () => {
    decode.mockResolvedValueOnce(new FakeBitmap(64, 31));
    await expect(read(SQUARE)).rejects.toThrow('another size');
    expect(FakeBitmap.open).toBe(0);
  });

  it('refuses a picture of another size than the index tells of', async () => {
    const expected = { level: 0, index: 0, own: 4, ghosts: 0, copies: 0, splits: 2, interior: 2, border: 0, pictureWidth: 64, pictureHeight: 32, hasNormalMap: false };
    await expect(read(SQUARE, {}, expected)).resolves.toBeDefined();
    await expect(read(SQUARE, {}, { ...expected, pictureWidth: 128 })).rejects.toThrow('not the tile that the index tells of');
  });
});

describe('Seam', () => {
  it('moves a ghost with its splits; each keeps its place in the picture', async () => {
    const [fine, coarse] = [await read(FINE), await read(COARSE)];
    const seam = new Seam(fine, new Tree(4));
    seam.look(new Map([fine, coarse].map((tile) => [keyOf(tile.level, tile.index), tile])));
    expect(seam.resolve()).toBe(2);
    expect([2, 3, 4].map((v) => [...fine.positions.subarray(3 * v, 3 * v + 3)])).toEqual([[0, 2, 0], [1, 2, 0], [0, 2, 0]]);
    expect([...fine.texcoords!]).toEqual(FINE.texcoords);
  });
});

describe('TileObject', () => {
  const made = async (parts: TileParts, look: Partial<Look> = {}): Promise<TileObject> => {
    const tile = await read(parts);
    const { level, index } = tile;
    const resident = { node: { level, index }, key: keyOf(level, index), tile, seam: new Seam(tile, new Tree(level + 2)) };
    return new TileObject(resident, { ...DEFAULT_LOOK, ...look }, sharedMaterials());
  };
  const lit = { ...SQUARE, picture: { ...PICTURE, unlit: false } };

  it("shows the picture's colours, no others, where they have their light", async () => {
    const { material, geometry } = await made(SQUARE);
    expect(material).toBeInstanceOf(MeshBasicMaterial);
    expect(material).toMatchObject({ toneMapped: false, vertexColors: false, transparent: false, alphaTest: 0 });
    expect(material.color.getHex()).toBe(0xffffff);
    expect(material.map).toMatchObject({ colorSpace: SRGBColorSpace, flipY: false, generateMipmaps: true, premultiplyAlpha: false });
    expect([...geometry.attributes.uv.array]).toEqual(SQUARE.texcoords);
  });

  it.each([true, false])('multiplies the picture by colours that tint it: unlit %s', async (unlit) => {
    const parts = { ...SQUARE, picture: { ...PICTURE, unlit } };
    const { material } = await made({ ...parts, coloursTint: true });
    expect(material).toMatchObject({ vertexColors: true, map: expect.anything() as unknown });
    const other = (await made(parts)).material;
    expect(other.vertexColors).toBe(false);
    expect(material.customProgramCacheKey()).not.toBe(other.customProgramCacheKey());
    expect((await made({ ...parts, coloursTint: true }, { colours: 'plain' })).material.vertexColors).toBe(false);
  });

  it('lights the picture where they have not', async () => {
    const { material } = await made(lit);
    expect(material).toBeInstanceOf(MeshStandardMaterial);
    expect(material.map).not.toBeNull();
    expect(material.vertexColors).toBe(false);
    expect(material.color.getHex()).toBe(0xffffff);
  });

  it('lights pictures that have their light where that is wanted', async () => {
    const { material } = await made(SQUARE, { relight: true });
    expect(material).toBeInstanceOf(MeshStandardMaterial);
    expect(material.map).not.toBeNull();
  });

  it.each<[Partial<Look>, number]>([[{}, 0xffffff], [{ texture: false, colours: 'plain' }, 0xd99a76], [{ texture: false, colours: 'height' }, 0xffffff]])('shows clay: %j', async (look, colour) => {
    const { material } = await made(lit, { material: 'matcap', ...look });
    expect(material).toBeInstanceOf(MeshMatcapMaterial);
    expect(material.color.getHex()).toBe(colour);
  });

  it('makes programs anew for another look, and only then', async () => {
    const object = await made(lit);
    const { material } = object;
    object.setLook({ ...DEFAULT_LOOK, relief: 9 });
    expect(object.material).toBe(material);
    for (const change of [{ cavities: false }, { material: 'matcap' }, { colours: 'height' }, { relight: true }] as const) {
      const before = object.material;
      object.setLook({ ...DEFAULT_LOOK, ...change });
      expect(object.material).not.toBe(before);
    }
  });

  it.each([['MASK', 0.5, false], ['BLEND', 1 / 512, true]])('shows holes: %s', async (alphaMode, alphaTest, transparent) => {
    const picture = { ...PICTURE, alphaMode };
    expect((await made({ ...SQUARE, picture })).material).toMatchObject({ alphaTest, transparent });
    expect((await made({ ...SQUARE, picture: { ...picture, unlit: false } })).material).toMatchObject({ alphaTest, transparent });
    expect((await made({ ...SQUARE, picture }, { texture: false })).material).toMatchObject({ alphaTest: 0, transparent: false });
  });

  it.each<[string, Partial<Look>, boolean]>([
    ["the vertices' colours without the texture", { texture: false }, true],
    ['the plain surface', { colours: 'plain' }, false],
    ['tiles of one colour', { colours: 'partition' }, false],
    ['tiles coloured by their error', { colours: 'error' }, false],
  ])('shows %s, lit', async (_, look, vertexColors) => {
    const object = await made(SQUARE);
    object.setLook({ ...DEFAULT_LOOK, ...look });
    expect(object.material).toBeInstanceOf(MeshStandardMaterial);
    expect(object.material).toMatchObject({ map: null, vertexColors });
    object.setLook(DEFAULT_LOOK);
    expect(object.material).toBeInstanceOf(MeshBasicMaterial);
    expect(object.material.map).not.toBeNull();
  });

  it('frees the picture on the GPU with itself, not before', async () => {
    const object = await made(SQUARE);
    const freed = vi.fn();
    (object.material.map as Texture).addEventListener('dispose', freed);
    object.setLook({ ...DEFAULT_LOOK, texture: false });
    object.hide();
    expect(freed).not.toHaveBeenCalled();
    object.dispose();
    expect(freed).toHaveBeenCalledOnce();
  });

  it.each([['is there once, on the GPU', COARSE, 0], ['stays, of the root', SQUARE, 1]])('closes the bitmap as soon as it was uploaded, so that it %s', async (_, parts, left) => {
    const object = await made(parts);
    const { map } = object.material;
    expect(FakeBitmap.open).toBe(1);
    map!.onUpdate?.(map!);
    expect(FakeBitmap.open).toBe(left);
  });

  it('counts the picture once, and the same after it was uploaded; of the root the bitmap too', async () => {
    const [tile, root] = [await read(COARSE), await read(SQUARE)];
    const ofPicture = (one: Tile): number => memoryOf(one, new Seam(one, new Tree(4)), false) - memoryOf({ ...one, picture: null }, new Seam(one, new Tree(4)), false);
    const onGpu = Math.ceil((4 / 3) * 4 * 64 * 32);
    expect(ofPicture(tile)).toBe(onGpu);
    dropPicture(tile.picture!);
    expect(ofPicture(tile)).toBe(onGpu);
    expect(ofPicture(root)).toBe(onGpu + 4 * 64 * 32);
  });

  it('takes as much memory as the index says, of the picture the very bytes', async () => {
    const tile = await read(FINE);
    const [bare, tree] = [{ ...tile, picture: null, texcoords: null }, new Tree(4)];
    const most = (pictureWidth: number, pictureHeight: number): number =>
      mostMemory({ own: 2, ghosts: 2, copies: 0, splits: 1, interior: 0, border: 2, pictureWidth, pictureHeight, hasNormalMap: false }, { level: 2, vertexBytes: vertexBytesOf(tile), wires: true, texelBytes: { plain: 4, mapped: 4 } });
    const bytes = memoryOf(tile, new Seam(tile, tree), true);
    const picture = Math.ceil((4 / 3) * 4 * 64 * 32); // on the GPU with what is made smaller of it
    expect(bytes - memoryOf(bare, new Seam(bare, tree), true)).toBe(picture + 2 * 8 * 5);
    expect(bytes).toBeLessThanOrEqual(most(64, 32));
    expect(most(64, 32) - most(0, 0)).toBe(picture + 2 * (8 + 4) * 5); // with room for tangents
  });
});

describe('TileStore', () => {
  const tree = new Tree(2);
  const record = { own: 3, ghosts: 0, copies: 0, splits: 0, interior: 1, border: 0, pictureWidth: 64, pictureHeight: 32, hasNormalMap: false, error: 0, bound: 0, min: [0, 0, 0], max: [1, 1, 1], bytes: 1, checksum: 0n } as const;
  const node = { level: 1, index: 0 };
  const withRoot = async (load: () => Promise<Tile>): Promise<TileStore> => {
    const nothing = (): void => undefined;
    const store = new TileStore({ load, bytesOf: () => 100, came: nothing, gone: nothing, failed: nothing }, () => tree, 1e6, 1);
    store.addRoot(await read(SQUARE), tree);
    return store;
  };
  const turn = async (): Promise<void> => new Promise((resolve) => setTimeout(resolve));

  it('closes the pictures of what it drops', async () => {
    const store = await withRoot(async () => read(COARSE));
    store.want([{ node, record, loadingBytes: 200 }], 1);
    await turn();
    expect(FakeBitmap.open).toBe(2);
    store.budget = 150;
    store.keepWithin(2);
    expect(FakeBitmap.open).toBe(1);
    store.dispose();
    expect(FakeBitmap.open).toBe(0);
  });

  it('closes the picture of what comes when nothing wants it any longer', async () => {
    let come: (tile: Tile) => void = () => undefined;
    const store = await withRoot(async () => new Promise((resolve) => { come = resolve; }));
    store.want([{ node, record, loadingBytes: 200 }], 1);
    store.want([], 1000);
    come(await read(COARSE));
    await turn();
    expect(FakeBitmap.open).toBe(1);
  });

  it('closes the picture of what is no tile of the tree', async () => {
    const store = await withRoot(async () => read({ ...FINE, level: 1, index: 0 }));
    store.want([{ node, record, loadingBytes: 200 }], 1);
    await turn();
    expect(FakeBitmap.open).toBe(1);
  });
});
