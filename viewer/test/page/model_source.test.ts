// SPDX-License-Identifier: MIT
import { resolveObjectURL } from 'node:buffer';
import { readdirSync, readFileSync, statSync } from 'node:fs';
import path from 'node:path';
import { gzipSync } from 'node:zlib';
import { describe, expect, it } from 'vitest';
import { ModelSource } from '../../page/gallery/model_source.js';
import { outlineBytes } from '../hierarchy/outline_bytes.js';
import { fetchFrom, hasProgram, Workshop } from '../support/meshhier.js';
import { RangedHost } from '../support/ranged_host.js';

const LINE = new Uint8Array(outlineBytes({ positions: [0, 0, 0, 1, 0, 0], segments: [0, 1] }));
const LOST = new Response(null, { status: 404 });

function packed(bytes: Uint8Array): Uint8Array<ArrayBuffer> {
  return new Uint8Array(gzipSync(bytes));
}

/// With the answers of its host, one after the other, and what it was asked.
function sourceOf(...answers: Response[]): { source: ModelSource; asked: string[] } {
  const asked: string[] = [];
  const fetch = (url: string): Promise<Response> => {
    asked.push(url);
    return Promise.resolve(answers[asked.length - 1]);
  };
  return { source: new ModelSource('http://host/a.hier', fetch), asked };
}

describe('the source of a model', () => {
  it('gives it once, and asks for it once', async () => {
    const { source, asked } = sourceOf(new Response(LINE));
    const shape = source.outline();
    expect(source.outline()).toBeNull();
    expect([...(await shape)!.ends]).toEqual([0, 0, 0, 1, 0, 0]);
    expect(source.outline()).toBeNull();
    expect(asked).toEqual(['http://host/a.hier/outline.glb']);
  });

  it('takes it out of its gzip', async () => {
    const { source } = sourceOf(new Response(packed(LINE)));
    expect((await source.outline())!.ends).toHaveLength(6);
  });

  it('asks again, once, after a failure', async () => {
    const { source } = sourceOf(LOST, new Response(LINE));
    await expect(source.outline()).rejects.toThrow('outline.glb: the host answered 404');
    expect((await source.outline())!.ends).toHaveLength(6);
  });

  it('gives up after the second failure', async () => {
    const { source } = sourceOf(LOST, LOST);
    await expect(source.outline()).rejects.toThrow('404');
    await expect(source.outline()).rejects.toThrow('404');
    expect(source.outline()).toBeNull();
  });

  it.each([['sent so', new Uint8Array(2 ** 20 + 1)], ['in gzip', packed(new Uint8Array(2 ** 20 + 1))]])(
    'refuses more than a mebibyte, %s',
    async (_, bytes) => {
      const { source } = sourceOf(new Response(bytes));
      await expect(source.outline()).rejects.toThrow('larger than 1048576 bytes');
    },
  );

  it('gives up what is on its way when it is closed', async () => {
    let signal: AbortSignal | null = null;
    const source = new ModelSource('http://host/a.hier', (_, init) => new Promise((_, reject) => {
      signal = init!.signal!;
      signal.addEventListener('abort', () => { reject(signal!.reason as Error); });
    }));
    const shape = source.outline();
    source.close();
    await expect(shape).rejects.toThrow('abort');
    expect(source.outline()).toBeNull();
  });

  it.runIf(hasProgram)('knows the sizes of a hierarchy', async () => {
    const workshop = new Workshop();
    const hierarchy = workshop.build('small', ['surface', '--triangles', '2000'], {});
    const fetch = fetchFrom(hierarchy);
    const { vertices, triangles, bytes } = await new ModelSource('.', fetch).facts();
    expect(triangles).toBeGreaterThan(1000);
    expect(vertices).toBeGreaterThan(500);
    expect(bytes).toBe(readdirSync(hierarchy, { recursive: true, withFileTypes: true }).reduce(
      (sum, entry) => sum + (entry.isFile() && entry.name !== 'hierarchy.json' ? statSync(path.join(entry.parentPath, entry.name)).size : 0), 0));
    workshop.remove();
  });

  it.runIf(hasProgram)('knows those of an archive, and its picture and outline', async () => {
    const workshop = new Workshop();
    const mesh = ['surface', '--triangles', '2000'];
    const host = new RangedHost(new Uint8Array(readFileSync(workshop.buildArchive('small', mesh, {}))));
    const picture = new Uint8Array(readFileSync(path.join(workshop.build('small', mesh, {}), 'preview.webp')));
    const source = new ModelSource('http://host/a.3tz', host.fetch);
    const { triangles, preview } = await source.facts();
    expect(triangles).toBeGreaterThan(1000);
    expect(preview).toMatch(/^blob:/);
    const blob = resolveObjectURL(preview!);
    expect(new Uint8Array(await blob!.arrayBuffer())).toEqual(picture);
    expect((await source.outline())!.ends.length).toBeGreaterThan(0);
    source.close();
    expect(resolveObjectURL(preview!)).toBeUndefined();
    workshop.remove();
  });

  it('says what is wrong with a manifest', async () => {
    const { source } = sourceOf(new Response('{}'));
    await expect(source.facts()).rejects.toThrow('hierarchy.json');
  });
});
