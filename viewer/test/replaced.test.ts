// SPDX-License-Identifier: MIT
// Hierarchies that another build takes the place of while they are read.
import { execFileSync } from 'node:child_process';
import { cpSync, existsSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { gunzipSync } from 'node:zlib';
import { afterAll, afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { Fetch } from '../src/hierarchy/bytes.js';
import { HierarchyView, type ViewOptions } from '../src/index.js';
import { fetchFrom, hasProgram, MESHHIER, withoutQuery, Workshop } from './support/meshhier.js';
import { RangedHost } from './support/ranged_host.js';
import { Session } from './support/session.js';

type Colour = 'red' | 'blue';

/// A wavy square of one colour.
function square(side: number, colour: Colour): string {
  const rgb = colour === 'red' ? '200 0 0' : '0 0 200';
  const numbers = Array.from({ length: (side + 1) ** 2 }, (_, i) => [(i % (side + 1)) / side, Math.floor(i / (side + 1)) / side]);
  const vertices = numbers.map(([x, z]) => `${x} ${0.05 * Math.sin(9 * x) * Math.sin(7 * z)} ${z} ${rgb}`);
  const faces = numbers.flatMap(([x, z], i) => (x === 1 || z === 1 ? [] : [`3 ${i} ${i + side + 1} ${i + 1}`, `3 ${i + 1} ${i + side + 1} ${i + side + 2}`]));
  const header = ['ply', 'format ascii 1.0', `element vertex ${vertices.length}`, ...['x', 'y', 'z'].map((axis) => `property float ${axis}`),
    ...['red', 'green', 'blue'].map((name) => `property uchar ${name}`), `element face ${faces.length}`, 'property list uchar int vertex_indices', 'end_header'];
  return [...header, ...vertices, ...faces, ''].join('\n');
}

describe.skipIf(!hasProgram)('a hierarchy that is replaced', () => {
  const workshop = new Workshop();
  const sessions: Session[] = [];
  beforeEach(() => { vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout', 'performance'] }); });
  afterEach(() => {
    for (const { view } of sessions.splice(0)) view.dispose();
    vi.useRealTimers();
  });
  afterAll(() => { workshop.remove(); });

  function build(side: number, colour: Colour, config: object): string {
    const name = `${side}_${colour}_${JSON.stringify(config).replace(/\W+/g, '_')}`;
    const mesh = path.join(workshop.directory, `${side}_${colour}.ply`);
    if (!existsSync(mesh)) writeFileSync(mesh, square(side, colour));
    return workshop.buildMesh(name, mesh, config);
  }

  /// The place that is served: first one build, then others.
  function place(build: string): string {
    const directory = path.join(workshop.directory, 'served.hier');
    rmSync(directory, { recursive: true, force: true });
    cpSync(build, `${directory}.part`, { recursive: true });
    renameSync(`${directory}.part`, directory);
    return directory;
  }

  function begin(fetch: Fetch, options: ViewOptions = {}, url = ''): Session & { replaced: number } {
    const session = Object.assign(new Session(fetch, { settings: { threshold: 0.5 }, ...options }, url), { replaced: 0 });
    session.view.addEventListener('replaced', () => { ++session.replaced; });
    session.look([0.6, 0.7, 1.2], [0.5, 0, 0.5]);
    sessions.push(session);
    return session;
  }

  /// Returns the colours of all vertices that are drawn.
  function colours(session: Session): Set<Colour | 'mixed'> {
    const seen = new Set<Colour | 'mixed'>();
    for (const { geometry: { attributes: { color } } } of session.meshes())
      for (let v = 0; v < color.count; ++v) seen.add(color.getX(v) > color.getZ(v) ? 'red' : 'blue');
    return seen;
  }

  /// Frames until so many tiles are there.
  async function refine(session: Session, tiles: number): Promise<void> {
    for (let frames = 0; frames < 400 && session.view.stats().residentTiles < tiles; ++frames) {
      await session.frame();
    }
  }

  /// A host that unpacks tiles, as one that sends Content-Encoding does for a page.
  function unpacking(known: Fetch): Fetch {
    return async (url, init) => {
      const answer = await known(url, init);
      return answer.ok && withoutQuery(url).endsWith('.glb') ? new Response(new Uint8Array(gunzipSync(Buffer.from(await answer.arrayBuffer())))) : answer;
    };
  }

  const plain = { partition: { vertices: 60 } };
  const packed = { ...plain, storage: { compression: 'zlib' } };
  const paged = { partition: { vertices: 9 } };

  it.each<[string, object, number, (fetch: Fetch) => Fetch]>([
    ['by other colours', plain, 50, (fetch) => fetch],
    ['in gzip', packed, 50, (fetch) => fetch],
    ['on a host that unpacks it', packed, 50, unpacking],
    ['of which the index comes in pages', paged, 60, (fetch) => fetch],
  ])('%s is never mixed, and is there when it is loaded anew', async (_, config, side, host) => {
    const directory = place(build(side, 'red', config));
    const session = begin(host(fetchFrom(directory)), { requests: 2 });
    await session.view.opened;
    await refine(session, 12);
    expect(colours(session)).toEqual(new Set(['red']));
    place(build(side, 'blue', config));
    for (let frames = 0; frames < 400 && session.replaced === 0; ++frames) {
      await session.frame();
      expect(colours(session)).toEqual(new Set(['red']));
    }
    expect(session.replaced).toBe(1);
    expect(session.problems).toEqual([]);
    const camera = session.camera.position.clone();
    session.look([0.5, 0.4, 0.6], [0.5, 0, 0.3]); // it goes on with what it has
    expect(await session.settle(10)).toBe(true);
    expect(colours(session)).toEqual(new Set(['red']));
    session.camera.position.copy(camera);
    await session.view.reload();
    expect(await session.settle(60)).toBe(true);
    expect(colours(session)).toEqual(new Set(['blue']));
    expect([session.replaced, session.missing, session.view.stats().failed]).toEqual([1, 0, 0]);
    expect(session.view.stats().tiles).toBeGreaterThan(8);
  });

  it('by another mesh is told as that, not as missing files', async () => {
    const directory = place(build(50, 'red', plain));
    const session = begin(fetchFrom(directory), { requests: 2 });
    await session.view.opened;
    await refine(session, 12);
    place(build(20, 'blue', plain));
    for (let frames = 0; frames < 400 && session.replaced === 0; ++frames) await session.frame();
    expect([session.replaced, session.missing]).toEqual([1, 0]);
    session.view.retry(); // of no use, and no harm
    await session.settle(5);
    expect(session.problems).toEqual([]);
    await session.view.reload();
    expect(await session.settle(60)).toBe(true);
    expect(colours(session)).toEqual(new Set(['blue']));
    expect(session.view.manifest?.source.vertices).toBe(21 * 21);
  });

  it.each(['the root came', 'the root came from a cache'])('when only %s begins anew by itself', async (what) => {
    const [red, blue] = [build(50, 'red', plain), build(50, 'blue', plain)].map((directory) => fetchFrom(directory));
    const isCached = what.endsWith('cache');
    let roots = 0;
    const session = begin((url, init) => {
      const isRed = url.includes('tiles/00/') && (isCached ? init?.cache !== 'reload' : roots++ === 0);
      return (isRed ? red : blue)(url, init);
    });
    expect(await session.settle(60)).toBe(true);
    expect(colours(session)).toEqual(new Set(['blue']));
    expect([session.replaced, session.problems]).toEqual([0, []]);
  });

  function archive(colour: Colour): Uint8Array<ArrayBuffer> {
    build(50, colour, plain); // makes the mesh
    const output = path.join(workshop.directory, `${colour}.3tz`);
    if (!existsSync(output)) execFileSync(MESHHIER, ['build', path.join(workshop.directory, `50_${colour}.ply`), '-o', output, '--set', 'partition.vertices=60', 'storage.normals=smooth', '--progress', 'none']);
    return new Uint8Array(readFileSync(output));
  }

  it.each([['seen', false], ['not seen', true]])('in an archive is never mixed, whose versions are %s', async (_, hidesHeaders) => {
    const [red, blue] = [archive('red'), archive('blue')];
    const host = new RangedHost(red, { hidesHeaders });
    const session = begin(host.fetch, { requests: 2 }, 'a.3tz');
    await session.view.opened;
    await refine(session, 6);
    [host.file, host.tag] = [blue, '"2"'];
    for (let frames = 0; frames < 400 && session.replaced === 0; ++frames) {
      await session.frame();
      expect(colours(session)).toEqual(new Set(['red']));
    }
    expect(session.replaced).toBe(1);
    await session.view.reload();
    expect(await session.settle(60)).toBe(true);
    expect(colours(session)).toEqual(new Set(['blue']));
    expect(session.problems).toEqual([]);
  });

  it('in an archive before its root has come begins anew by itself', async () => {
    const host = new RangedHost(archive('red'));
    let asked = 0;
    const fetch: Fetch = (url, init) => {
      if (++asked === 2) [host.file, host.tag] = [archive('blue'), '"2"'];
      return host.fetch(url, init);
    };
    const view = new HierarchyView('a.3tz', { fetch });
    await view.opened;
    view.dispose();
  });

  it('is not what a damaged tile is', async () => {
    const directory = place(build(50, 'red', plain));
    const file = path.join(directory, 'tiles/02/000001.glb');
    const bytes = readFileSync(file);
    bytes[bytes.length - 9] ^= 1;
    writeFileSync(file, bytes);
    const session = begin(fetchFrom(directory));
    expect(await session.settle(60)).toBe(true);
    expect(session.replaced).toBe(0);
    expect(session.problems[0]).toContain('tiles/02/000001.glb: its size or checksum is not that of the index');
  });

  it('is a lasting one where the page holds the model itself', async () => {
    const directory = place(build(50, 'red', plain));
    const { EmbeddedFiles } = await import('../page/embedded.js');
    const { remoteFiles } = await import('../src/hierarchy/remote_files.js');
    const held = new Map(['hierarchy.json', 'tiles.bin', 'tiles/00/000000.glb', 'tiles/01/000000.glb', 'tiles/01/000001.glb', 'outline.glb']
      .map((name) => [name, readFileSync(path.join(directory, name)).toString('base64')]));
    place(build(50, 'blue', plain));
    const session = begin(fetchFrom(directory), { files: new EmbeddedFiles(held, remoteFiles('', fetchFrom(directory))) });
    let isLasting = false;
    session.view.addEventListener('replaced', (event) => { ({ isLasting } = event); });
    expect(await session.settle(60)).toBe(true);
    expect([isLasting, session.replaced, session.view.stats().tiles]).toEqual([true, 1, 2]);
    expect(colours(session)).toEqual(new Set(['red']));
  });

  it('comes though the host says nothing for a while, without anybody\'s doing', async () => {
    const known = fetchFrom(place(build(50, 'red', plain)));
    let isSilent = false;
    const session = begin((url, init) => {
      if (!isSilent) return known(url, init);
      return new Promise((_, reject) => { init?.signal?.addEventListener('abort', () => { reject(new Error('ended')); }); });
    });
    await session.view.opened;
    await refine(session, 3);
    isSilent = true;
    await session.settle(150);
    expect(session.missing).toBeGreaterThan(0);
    expect(session.problems[0]).toContain('the host has sent nothing for 20 seconds');
    isSilent = false;
    expect(await session.settle(60)).toBe(true);
    for (let seconds = 0; seconds < 60 && session.missing > 0; ++seconds) await session.settle(1).then(() => session.frame());
    expect(session.missing).toBe(0);
  });
});
