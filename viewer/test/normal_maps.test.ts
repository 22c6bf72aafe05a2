// SPDX-License-Identifier: MIT
// Tiles with normal maps.
import { MeshBasicMaterial, MeshMatcapMaterial, MeshStandardMaterial, NoColorSpace, SRGBColorSpace, type Texture } from 'three';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Seam } from '../src/cut/seam.js';
import { HierarchyProblem } from '../src/hierarchy/problem.js';
import { letGo } from '../src/hierarchy/let_go.js';
import { partsOf, readTile, type Tile } from '../src/hierarchy/tile.js';
import { Tree, keyOf } from '../src/hierarchy/tree.js';
import { sharedMaterials } from '../src/scene/materials.js';
import { DEFAULT_LOOK, type Look } from '../src/scene/settings.js';
import { TileObject, memoryOf, mostMemory, texelBytesOf, vertexBytesOf } from '../src/scene/tile_object.js';
import { FakeBitmap, jpeg, png } from './support/pictures.js';
import { packedTileBytes, tileBytes, type TileParts } from './support/tile_bytes.js';

const MAP = { file: jpeg(64, 32), mimeType: 'image/jpeg', width: 64, height: 32 };
const UP = [0, 0, 127];
const ASIDE = [90, 0, 90];
const TANGENT = [127, 0, 0, -127];

function of(count: number, values: readonly number[]): number[] {
  return Array.from({ length: count }, () => values).flat();
}

const ROOT: TileParts = {
  own: 3,
  splitOf: [0],
  positions: [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0],
  codes: of(4, UP),
  tangents: of(4, TANGENT),
  texcoords: [0, 0, 1, 0, 0, 1, 0.2, 0.4],
  colours: of(4, [255, 0, 0, 255]),
  normalMap: MAP,
  interior: [0, 1, 2, 3, 2, 1],
};

/// Two boundary vertices, two ghosts of tile 2/1.
const FINE: TileParts = {
  level: 2, index: 2, own: 2, ghosts: 2,
  positions: [0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0],
  codes: of(4, UP),
  interior: [], border: [0, 1, 2, 1, 3, 2],
  neighbours: [1], ghostStarts: [0, 2], chains: [0, 1, 1, 0],
};
const COARSE: TileParts = { level: 1, index: 0, own: 3, positions: [1, 2, 0, 0, 2, 0, 5, 5, 5], codes: of(3, ASIDE), interior: [0, 1, 2] };
const mapped = (parts: TileParts): TileParts => {
  const vertices = parts.positions.length / 3;
  return { ...parts, normalMap: MAP, tangents: of(vertices, TANGENT), texcoords: of(vertices, [0.5, 0.5]) };
};

const PICTURE = { ...MAP, mimeType: 'image/png', file: png(64, 32) };
/// Coordinates are those of the picture.
const RELIEF: TileParts = { ...ROOT, picture: PICTURE };

async function read(parts: TileParts, change: Record<string, number> = {}): Promise<Tile> {
  return readTile(tileBytes(parts, change), 'tile.glb', null);
}

beforeEach(() => {
  FakeBitmap.open = 0;
  vi.stubGlobal('createImageBitmap', async () => Promise.resolve(new FakeBitmap(64, 32)));
});
afterEach(() => {
  vi.unstubAllGlobals();
});

describe('readTile', () => {
  it('reads the map, its coordinates and tangents, packed or not', async () => {
    const tile = await read(ROOT);
    expect(tile.picture).toBeNull();
    expect(tile.normalMap).toMatchObject({ width: 64, height: 32 });
    ROOT.texcoords!.forEach((part, i) => { expect(tile.texcoords![i]).toBeCloseTo(part, 4); });
    expect([...tile.tangents!]).toEqual(ROOT.tangents);
    expect(tile.coloursTint).toBe(false);
    expect(await readTile(await packedTileBytes(ROOT), 'tile.glb', null)).toEqual(tile);
  });

  it('reads the map beside a picture, with the same coordinates', async () => {
    const tile = await read(RELIEF);
    expect(tile.picture).toMatchObject({ width: 64, height: 32, unlit: false });
    expect(tile.normalMap).toMatchObject({ width: 64, height: 32, alpha: 'OPAQUE' });
    expect(tile.normalMap!.texels).not.toBe(tile.picture!.texels);
    expect([...tile.texcoords!]).toEqual([...Float32Array.from(ROOT.texcoords!)]);
    expect([...tile.tangents!]).toEqual(ROOT.tangents);
    expect(partsOf(tile)).toEqual(expect.arrayContaining([tile.picture!.texels, tile.normalMap!.texels]));
    letGo(tile);
    expect(FakeBitmap.open).toBe(0);
  });

  it('lets go of a picture whose map is none', async () => {
    await expect(read({ ...RELIEF, normalMap: { ...MAP, file: Uint8Array.of(1, 2, 3, 4) } })).rejects.toThrow('is no JPEG');
    expect(FakeBitmap.open).toBe(0);
  });

  it('reads a tile whose map has not come', async () => {
    const tile = await readTile(tileBytes(RELIEF), 'tile.glb', null, true);
    expect(tile.normalMap).toBeNull();
    expect(tile).toEqual({ ...(await read(RELIEF)), picture: tile.picture, normalMap: null });
  });

  it('hands the map over, and lets go of it', async () => {
    const tile = await read(ROOT);
    expect(partsOf(tile)).toEqual(expect.arrayContaining([tile.normalMap!.texels, tile.tangents!.buffer]));
    letGo(tile);
    expect(FakeBitmap.open).toBe(0);
  });

  it.each<[string, Partial<TileParts>, Record<string, number>, string]>([
    ['a map without tangents', { tangents: undefined }, {}, 'a normal map without tangents'],
    ['a map without coordinates', { texcoords: undefined }, {}, 'without texture coordinates'],
    ['fewer tangents than vertices', { tangents: of(3, TANGENT) }, {}, 'has not the 16 bytes'],
    ['a map of one side', {}, { normalMapHeight: 0 }, 'one side only'],
    ['a map larger than any', {}, { normalMapWidth: 8193 }, 'is not from 0 to 8192'],
    ['a map that is not there', {}, { normalMap: -1 }, 'is no file'],
    ['a map of another size', { normalMap: { ...MAP, file: jpeg(64, 33) } }, {}, 'has another size'],
    ['a picture of another size than the map', { picture: PICTURE }, { imageHeight: 16 }, 'have different sides'],
    ['a newer version', {}, { version: 8 }, 'version 8 of MESHHIER_tile is not known'],
  ])('refuses %s', async (_, parts, change, problem) => {
    const refused = read({ ...ROOT, ...parts }, change);
    await expect(refused).rejects.toBeInstanceOf(HierarchyProblem);
    await expect(refused).rejects.toThrow(problem);
  });
});

describe('Seam', () => {
  const ghostNormal = async (fineParts: TileParts, coarseParts: TileParts): Promise<number[]> => {
    const [fine, coarse] = [await read(fineParts), await read(coarseParts)];
    const seam = new Seam(fine, new Tree(4));
    seam.look(new Map([fine, coarse].map((tile) => [keyOf(tile.level, tile.index), tile])));
    seam.resolve();
    expect([...fine.positions.subarray(6, 9)]).toEqual([0, 2, 0]);
    return [...fine.normals.subarray(8, 11)];
  };

  it('gives a ghost the normal of the coarser tile', async () => {
    expect(await ghostNormal(FINE, COARSE)).toEqual(ASIDE);
  });

  it.each([[mapped(FINE), COARSE], [FINE, mapped(COARSE)], [mapped(FINE), mapped(COARSE)]])('leaves it its own where one of them has a map', async (fine, coarse) => {
    expect(await ghostNormal(fine, coarse)).toEqual(UP);
  });
});

describe('TileObject', () => {
  const made = async (parts: TileParts, look: Partial<Look> = {}): Promise<TileObject> => {
    const tile = await read(parts);
    const resident = { node: tile, key: keyOf(tile.level, tile.index), tile, seam: new Seam(tile, new Tree(4)) };
    return new TileObject(resident, { ...DEFAULT_LOOK, ...look }, sharedMaterials());
  };

  it('is lit by the map, as numbers, beside the colours', async () => {
    const { material, geometry } = await made(ROOT);
    expect(material).toBeInstanceOf(MeshStandardMaterial);
    expect((material as MeshStandardMaterial).normalMap).toMatchObject({ colorSpace: NoColorSpace, flipY: false });
    expect(material).toMatchObject({ map: null, vertexColors: true });
    expect(geometry.attributes.tangent).toMatchObject({ itemSize: 4, normalized: true });
  });

  it('is lit so as clay too, but shows facets as they are', async () => {
    const clay = await made(ROOT, { material: 'matcap' });
    expect(clay.material).toBeInstanceOf(MeshMatcapMaterial);
    expect((clay.material as MeshMatcapMaterial).normalMap).not.toBeNull();
    expect(((await made(ROOT, { shading: 'flat' })).material as MeshStandardMaterial).normalMap).toBeNull();
  });

  it('is lit by the map under its picture, and without the picture', async () => {
    const { material, geometry } = await made(RELIEF);
    expect(material).toBeInstanceOf(MeshStandardMaterial);
    const { map, normalMap } = material as MeshStandardMaterial;
    expect(map).toMatchObject({ colorSpace: SRGBColorSpace });
    expect(normalMap).toMatchObject({ colorSpace: NoColorSpace });
    expect(geometry.attributes.uv.count).toBe(geometry.attributes.tangent.count);
    expect((await made(RELIEF, { texture: false })).material).toMatchObject({ map: null, normalMap: { colorSpace: NoColorSpace } });
  });

  it('is lit under its picture without a map, too, as its neighbours are', async () => {
    const [mappedTile, plain] = [await made(RELIEF), await made({ ...RELIEF, normalMap: undefined, tangents: undefined })];
    expect(plain.material).toBeInstanceOf(MeshStandardMaterial);
    for (const key of ['color', 'roughness', 'metalness', 'vertexColors'] as const) expect(plain.material).toHaveProperty(key, (mappedTile.material as MeshStandardMaterial)[key]);
  });

  it('frees the map with itself', async () => {
    const object = await made(ROOT);
    const freed = vi.fn();
    ((object.material as MeshStandardMaterial).normalMap as Texture).addEventListener('dispose', freed);
    object.dispose();
    expect(freed).toHaveBeenCalledOnce();
  });

  it.each([ROOT, RELIEF])('takes no more memory than the index says', async (parts) => {
    const tile = await read(parts);
    const counts = { own: 3, ghosts: 0, copies: 0, splits: 1, interior: 2, border: 0, pictureWidth: 64, pictureHeight: 32, hasNormalMap: true };
    const most = mostMemory(counts, { level: 0, vertexBytes: vertexBytesOf(tile), wires: false, texelBytes: texelBytesOf(tile) });
    const bytes = memoryOf(tile, new Seam(tile, new Tree(4)), false);
    expect(bytes).toBeLessThanOrEqual(most);
    expect(bytes).toBeGreaterThan((parts.picture ? 2 : 1) * 4 * 64 * 32);
  });
});

describe('the samples of a tile', () => {
  const made = async (parts: TileParts, look: Partial<Look> = {}): Promise<TileObject> => {
    const tile = await read(parts);
    return new TileObject({ node: tile, key: 0, tile, seam: new Seam(tile, new Tree(4)) }, { ...DEFAULT_LOOK, ...look }, sharedMaterials());
  };
  const bare = (parts: TileParts): TileParts => ({ ...parts, normalMap: undefined, tangents: undefined, texcoords: parts.picture && parts.texcoords });

  it.each([[ROOT, bare(ROOT)], [RELIEF, bare(RELIEF)]])('have the materials and the attributes of one with a map and one without', async (parts, without) => {
    const [one, other] = [await made(parts), await made(without)];
    const kind = ({ material, geometry }: Pick<TileObject, 'material' | 'geometry'>): unknown[] =>
      [material.type, material.customProgramCacheKey(), (material as MeshStandardMaterial).normalMap !== null, Object.entries(geometry.attributes).filter(([name]) => name !== 'uv').map(([name, { itemSize }]) => [name, itemSize]).sort()];
    for (const each of [one, other]) expect(each.makeSamples().map(kind)).toEqual([kind(one), kind(other)]);
  });

  it('are none where no light is', async () => {
    const unlit = await made({ ...bare(RELIEF), picture: { ...PICTURE, unlit: true } });
    expect(unlit.material).toBeInstanceOf(MeshBasicMaterial);
    expect(unlit.makeSamples()).toEqual([]);
  });
});
