import { readFileSync } from 'node:fs';
import path from 'node:path';
import { afterAll, describe, expect, it } from 'vitest';
import { readManifest } from '../src/hierarchy/manifest.js';
import { HierarchyProblem } from '../src/hierarchy/problem.js';
import { RemoteHierarchy } from '../src/hierarchy/remote_hierarchy.js';
import { TileDecoder } from '../src/hierarchy/tile_decoder.js';
import { Tree } from '../src/hierarchy/tree.js';
import { fetchFrom, hasProgram, Workshop } from './support/meshhier.js';
import type { Fetch } from '../src/hierarchy/bytes.js';

const ROOT = { level: 0, index: 0 };

function remote(fetch: Fetch): RemoteHierarchy {
  return new RemoteHierarchy('', fetch, new TileDecoder(undefined, 0));
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
    const { index, tree } = await from.directory(manifest, come, come);
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
    const { index, tree } = await from.directory(await from.manifest(), () => undefined, () => undefined);
    expect(index.record({ level: tree.lastLevel, index: tree.partitions - 1 })!.error).toBe(0);
    expect(asked).toHaveLength(2);
  });

  it('refuses an index of another hierarchy, and a short one', async () => {
    const hierarchy = large();
    const bytes = new Uint8Array(readFileSync(path.join(hierarchy, 'tiles.bin')));
    const manifest = readManifest(readFileSync(path.join(hierarchy, 'hierarchy.json'), 'utf8'));
    for (const wrong of [bytes.subarray(0, 100), new Uint8Array(70_000)]) {
      const from = remote(() => Promise.resolve(new Response(new Uint8Array(wrong))));
      await expect(from.directory(manifest, () => undefined, () => undefined)).rejects.toBeInstanceOf(HierarchyProblem);
    }
    const less = { ...manifest, partitions: manifest.partitions - 1 };
    await expect(remote(fetchFrom(hierarchy)).directory(less, () => undefined, () => undefined)).rejects.toBeInstanceOf(HierarchyProblem);
    expect(new Tree(less.partitions).tileCount).toBe(manifest.partitions * 2 - 3);
  });
});

describe('readManifest', () => {
  const hostile = ['', '[]', 'null', '{}', '{"format":"meshhier"}', '{"format":"meshhier","format_version":5}',
    '{"format":"meshhier","format_version":4,"source":[]}', '{"__proto__":{"format":"meshhier"}}'];
  it.each(hostile)('refuses %s', (text) => {
    expect(() => readManifest(text)).toThrow(HierarchyProblem);
  });
});
