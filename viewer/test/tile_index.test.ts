// SPDX-License-Identifier: MIT
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { afterAll, describe, expect, it, vi } from 'vitest';
import { readManifest } from '../src/hierarchy/manifest.js';
import { HierarchyProblem } from '../src/hierarchy/problem.js';
import { remoteFiles } from '../src/hierarchy/remote_files.js';
import { RemoteHierarchy } from '../src/hierarchy/remote_hierarchy.js';
import { TileDecoder } from '../src/hierarchy/tile_decoder.js';
import { Tree } from '../src/hierarchy/tree.js';
import { fetchFrom, hasProgram, Workshop } from './support/meshhier.js';
import type { Fetch } from '../src/hierarchy/bytes.js';

const ROOT = { level: 0, index: 0 };

function remote(fetch: Fetch): RemoteHierarchy {
  return new RemoteHierarchy(remoteFiles('', fetch), new TileDecoder(undefined, 0), new AbortController().signal);
}

function whenCome(): { promise: Promise<void>; come: () => void } {
  let come = (): void => undefined;
  const promise = new Promise<void>((resolve) => {
    come = resolve;
  });
  return { promise, come };
}

describe.skipIf(!hasProgram)('TileIndex', () => {
  const workshop = new Workshop();
  afterAll(() => {
    workshop.remove();
  });
  const large = (): string =>
    workshop.build('large', ['surface', '--triangles', '12000'], { partition: { vertices: 8 }, simplify: { vertices: 8 } });

  it('fetches the pages that are looked into, no others', async () => {
    const hierarchy = large();
    const asked: string[] = [];
    const from = remote(fetchFrom(hierarchy, asked));
    const manifest = await from.manifest();
    const { promise, come } = whenCome();
    const { index, tree } = await from.directory(manifest, await from.root(), come, come);
    const last = { level: tree.lastLevel, index: tree.partitions - 1 };
    expect(index.record(ROOT)!.error).toBeGreaterThan(0);
    expect(index.record(last)).toBeNull();
    await promise;
    expect(index.record(last)!.error).toBe(0);
    expect(asked.filter((url) => url.endsWith('tiles.bin'))).toHaveLength(2);
  });

  it('takes all of it from a host that knows no ranges', async () => {
    const hierarchy = large();
    const known = fetchFrom(hierarchy);
    const asked: string[] = [];
    const from = remote((url) => {
      asked.push(url);
      return known(url);
    });
    const { index, tree } = await from.directory(await from.manifest(), await from.root(), () => undefined, () => undefined);
    expect(index.record({ level: tree.lastLevel, index: tree.partitions - 1 })!.error).toBe(0);
    expect(asked).toHaveLength(3);
  });

  it('asks again for a page that did not come', async () => {
    const hierarchy = large();
    const known = fetchFrom(hierarchy);
    let isDown = false;
    const from = remote((url, init) => (isDown ? Promise.reject(new TypeError('down')) : known(url, init)));
    const problems: unknown[] = [];
    const { promise, come } = whenCome();
    const { index, tree } = await from.directory(await from.manifest(), await from.root(), come, (problem) => problems.push(problem));
    const last = { level: tree.lastLevel, index: tree.partitions - 1 };
    const clock = vi.spyOn(performance, 'now');
    isDown = true;
    expect(index.record(last)).toBeNull();
    await vi.waitFor(() => {
      expect(problems).toHaveLength(1);
    });
    isDown = false;
    const now = performance.now();
    expect(index.record(last)).toBeNull();
    clock.mockReturnValue(now + 10_000);
    expect(index.record(last)).toBeNull();
    await promise;
    clock.mockRestore();
    expect(index.record(last)!.error).toBe(0);
  });

  it.each<[string, number, number]>([
    ['an error that is no number', 48, 0x7fc00000],
    ['more splits than corners', 84, 2 ** 20],
    ['a picture with one side', 88, 512],
  ])('tells of a damaged record, with %s, and goes on with the others', async (_, offset, value) => {
    const hierarchy = large();
    const known = fetchFrom(hierarchy);
    const from = remote(async (url, init) => {
      const response = await known(url, init);
      if (!url.endsWith('tiles.bin')) return response;
      const bytes = new Uint8Array(await response.arrayBuffer());
      new DataView(bytes.buffer).setUint32(32 + 2 * 120 + offset, value, true);
      return new Response(bytes, { status: response.status });
    });
    const problems: unknown[] = [];
    const { index } = await from.directory(await from.manifest(), await from.root(), () => undefined, (problem) => problems.push(problem));
    const hurt = { level: 1, index: 1 };
    for (let times = 0; times < 3; ++times) expect(index.record(hurt)).toBeNull();
    expect(index.isLost(hurt)).toBe(true);
    expect(index.record({ level: 1, index: 0 })).not.toBeNull();
    expect(problems).toHaveLength(1);
  });

  it('refuses an index of another hierarchy, and a short one', async () => {
    const hierarchy = large();
    const bytes = new Uint8Array(readFileSync(path.join(hierarchy, 'tiles.bin')));
    const manifest = readManifest(readFileSync(path.join(hierarchy, 'hierarchy.json'), 'utf8'));
    const root = await remote(fetchFrom(hierarchy)).root();
    for (const wrong of [bytes.subarray(0, 100), new Uint8Array(70_000)]) {
      const from = remote(() => Promise.resolve(new Response(new Uint8Array(wrong))));
      await expect(from.directory(manifest, root, () => undefined, () => undefined)).rejects.toBeInstanceOf(HierarchyProblem);
    }
    const less = { ...manifest, partitions: manifest.partitions - 1 };
    await expect(remote(fetchFrom(hierarchy)).directory(less, root, () => undefined, () => undefined)).rejects.toBeInstanceOf(HierarchyProblem);
    expect(new Tree(less.partitions).tileCount).toBe(manifest.partitions * 2 - 3);
  });
});

describe('readManifest', () => {
  const SUM = '0123456789abcdef';
  const hostile = ['', '[]', 'null', '{}', '{"format":"meshhier"}', '{"format":"meshhier","format_version":9}',
    '{"format":"meshhier","format_version":6,"source":[]}', '{"__proto__":{"format":"meshhier"}}'];
  it.each(hostile)('refuses %s', (text) => {
    expect(() => readManifest(text)).toThrow(HierarchyProblem);
  });

  const textured = (textures: unknown, texture: unknown): string => {
    const source = { file_name: 'a.obj', file_bytes: 1, vertices: 3, triangles: 1, attributes: { colours: 'none', normals: false }, bounds: { min: [0, 0, 0], max: [1, 1, 1] }, double_precision: false, textures };
    return JSON.stringify({ format: 'meshhier', format_version: 6, source, origin: [0, 0, 0], up: 'y', transform: null, licence: '', partitions: 1, total_bytes: 1,
      storage: { positions: null, texture, compression: 'none' }, index: { file: 'tiles.bin', bytes: 152, checksum: SUM }, outline: { file: 'outline.glb', bytes: 9, checksum: SUM }, checksum: SUM });
  };
  const stored = { format: 'webp', quality: 90, unlit: true };

  it('knows seven versions of the format', () => {
    for (const version of [6, 7, 8, 9, 10, 11, 12])
      expect(readManifest(textured(undefined, undefined).replace('"format_version":6', `"format_version":${version}`)).partitions).toBe(1);
  });

  it('tells of units', () => {
    const text = textured(undefined, undefined);
    const withUnits = (units: string): string => text.replace('"up":"y"', `"up":"y","units":${units}`);
    expect(readManifest(text).units).toBeNull();
    expect(readManifest(withUnits('"us_ft"')).units).toBe('us_ft');
    for (const wrong of ['"furlong"', 'null', '1']) expect(() => readManifest(withUnits(wrong))).toThrow(HierarchyProblem);
  });

  it('tells of pictures', () => {
    expect(readManifest(textured(undefined, undefined)).source.textures).toBeNull();
    expect(readManifest(textured({ images: 3, missing_images: 1 }, stored)).source.textures).toEqual({ images: 3, missingImages: 1 });
  });

  it.each<[string, unknown, unknown, string]>([
    ['pictures of which nobody says how they are stored', { images: 1, missing_images: 0 }, undefined, '"storage.texture" is not an object'],
    ['stored pictures that nobody has', undefined, stored, '"source.textures" is not an object'],
    ['pictures of another kind', { images: 1, missing_images: 0 }, { ...stored, format: 'bmp' }, 'one of jpeg, png, webp'],
    ['more missing pictures than there are', { images: 1, missing_images: 2 }, stored, 'from 0 to 1'],
  ])('refuses %s', (_, textures, texture, problem) => {
    expect(() => readManifest(textured(textures, texture))).toThrow(problem);
  });

  it('tells where the model stands, and refuses what is no transform', () => {
    const placed = (transform: unknown): string => textured(undefined, undefined).replace('"transform":null', `"transform":${JSON.stringify(transform)}`);
    const transform = Array.from({ length: 16 }, (_, i) => i);
    expect(readManifest(placed(transform)).transform).toEqual(transform);
    expect(readManifest(placed(null))).toMatchObject({ transform: null, worstRounding: 0, source: { doublePrecision: false } });
    expect(() => readManifest(placed(transform.slice(1)))).toThrow('"transform.15" is not a number');
    expect(() => readManifest(placed(['x']))).toThrow('"transform.0" is not a number');
  });

  it('says what to do about a hierarchy of an older version', () => {
    expect(() => readManifest('{"format":"meshhier","format_version":5}')).toThrow('build the hierarchy again');
  });
});
