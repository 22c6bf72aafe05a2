// SPDX-License-Identifier: MIT
// Hierarchies in an archive, from hosts that know ranges and such that do not.
import { createHash } from 'node:crypto';
import { readdirSync, readFileSync, statSync } from 'node:fs';
import path from 'node:path';
import { afterAll, describe, expect, it } from 'vitest';
import { archivedBytes, findInIndex, isArchiveUrl } from '../src/hierarchy/archive_format.js';
import { RemoteArchive } from '../src/hierarchy/remote_archive.js';
import { whole, type RemoteFiles } from '../src/hierarchy/files.js';
import { remoteFiles } from '../src/hierarchy/remote_files.js';
import { RemoteHierarchy, type Directory } from '../src/hierarchy/remote_hierarchy.js';
import { TileDecoder } from '../src/hierarchy/tile_decoder.js';
import { tilePath, type Node } from '../src/hierarchy/tree.js';
import { hasProgram, Workshop } from './support/meshhier.js';
import { RangedHost, type HostHabits } from './support/ranged_host.js';

const URL_ = 'https://host/models/a.3tz';
const MOST = 2 ** 26;
const ROOT = tilePath({ level: 0, index: 0 });
const none = (): void => undefined;

function md5(name: string): Uint8Array {
  return new Uint8Array(createHash('md5').update(name).digest());
}

/// An index as archives have it, of files that lie at their number.
function indexOf(names: readonly string[]): Uint8Array {
  const places = names.map((name, number) => {
    const place = Buffer.alloc(24, md5(name));
    place.writeBigUInt64LE(BigInt(number), 16);
    return place;
  });
  const key = (place: Buffer): bigint => (place.readBigUInt64LE(0) << 64n) + place.readBigUInt64LE(8);
  places.sort((a, b) => (key(a) < key(b) ? -1 : 1));
  return new Uint8Array(Buffer.concat(places));
}

describe('the index of an archive', () => {
  it.each([1, 2, 3, 100, 2730, 2731, 20_000])('finds each of %d names, most in one look', async (count) => {
    const names = Array.from({ length: count }, (_, i) => `tiles/07/${String(i).padStart(6, '0')}.glb`);
    const index = indexOf(names);
    let looks = 0;
    const read = (first: number, end: number): Promise<Uint8Array> => {
      ++looks;
      return Promise.resolve(index.subarray(first, end));
    };
    const find = (name: string): Promise<number | null> => findInIndex(md5(name), { offset: 0, count }, read, 'a.3tz');
    const some = names.filter((_, i) => i % Math.ceil(count / 500) === 0);
    for (const name of some) expect(await find(name)).toBe(names.indexOf(name));
    expect(looks).toBeLessThanOrEqual(some.length * 1.1);
    for (let i = 0; i < 20; ++i) expect(await find(`other ${i}`)).toBeNull();
  });

  it('that is in no order ends with an answer', async () => {
    const index = indexOf(Array.from({ length: 20_000 }, (_, i) => String(i)));
    const places = Array.from({ length: 20_000 }, (_, i) => index.subarray(24 * i, 24 * i + 24));
    places.sort((a, b) => a[5] - b[5]);
    const shuffled = new Uint8Array(Buffer.concat(places));
    const read = (first: number, end: number): Promise<Uint8Array> => Promise.resolve(shuffled.subarray(first, end));
    for (let i = 0; i < 200; ++i) await findInIndex(md5(String(i)), { offset: 0, count: 20_000 }, read, 'a.3tz').catch((problem: unknown) => { expect(String(problem)).toContain('a.3tz'); });
  });
});

describe('the URL of an archive', () => {
  it.each([['https://h/a.3tz', true], ['https://h/A.3TZ?signed=1', true], ['a.3tz#x', true], ['https://h/a.3tz/', false], ['https://h/a.hier', false], ['https://h/?a.3tz', false]])(
    '%s: %s',
    (url, isArchive) => { expect(isArchiveUrl(url)).toBe(isArchive); },
  );
});

interface Opened {
  readonly host: RangedHost;
  readonly files: RemoteFiles;
  readonly remote: RemoteHierarchy;
}

function open(archive: Uint8Array<ArrayBuffer>, habits: HostHabits = {}): Opened {
  const host = new RangedHost(archive, habits);
  const files = remoteFiles(URL_, host.fetch);
  return { host, files, remote: new RemoteHierarchy(files, new TileDecoder(undefined, 0), new AbortController().signal) };
}

async function directoryOf({ remote }: Opened): Promise<Directory> {
  return remote.directory(await remote.manifest(), await remote.root(), none, none);
}

describe.skipIf(!hasProgram)('a remote archive', () => {
  const workshop = new Workshop();
  afterAll(() => { workshop.remove(); });
  const small = (): { directory: string; archive: Uint8Array<ArrayBuffer> } => {
    const config = { partition: { vertices: 500 }, simplify: { vertices: 500 } };
    const mesh = ['surface', '--triangles', '12000'];
    const archive = new Uint8Array(readFileSync(workshop.buildArchive('small', mesh, config)));
    return { directory: workshop.build('small', mesh, config), archive };
  };
  /// Makes an archive of more tiles than a page of the index has.
  const large = (): Uint8Array<ArrayBuffer> =>
    new Uint8Array(readFileSync(workshop.buildArchive('large', ['surface', '--triangles', '12000'], { partition: { vertices: 8 }, simplify: { vertices: 8 } })));

  const habits: [string, HostHabits][] = [['of any host', {}], ['of a host that hides its headers', { hidesHeaders: true }], ['that come in pieces', { pieces: 1000 }], ['sent whole', { knowsNoRanges: true }]];
  it.each(habits)('has the files of the directory, parts %s', async (_, how) => {
    const { directory, archive } = small();
    const { files } = open(archive, how);
    const names = readdirSync(directory, { recursive: true, encoding: 'utf8' }).filter((name) => statSync(path.join(directory, name)).isFile());
    expect(names.length).toBeGreaterThan(20);
    for (const name of names) expect(Buffer.compare(await whole(files, name, MOST), readFileSync(path.join(directory, name))), name).toBe(0);
    await expect(whole(files, 'tiles/09/000000.glb', MOST)).rejects.toThrow('tiles/09/000000.glb: is not in a.3tz');
  });

  it('gives the root after two requests, and the tiles below it after one more of the index', async () => {
    const opened = open(small().archive);
    const manifest = await opened.remote.manifest();
    const root = await opened.remote.root();
    expect(opened.host.asked).toHaveLength(2);
    const { index } = await opened.remote.directory(manifest, root, none, none);
    expect(opened.host.asked).toHaveLength(3);
    const nodes: Node[] = [{ level: 1, index: 0 }, { level: 1, index: 1 }];
    const { signal } = new AbortController();
    const tiles = await Promise.all(nodes.map((node) => opened.remote.tile(node, index.record(node)!, signal)));
    expect(tiles.map(({ level, index }) => ({ level, index }))).toEqual(nodes);
    expect(opened.host.asked).toHaveLength(4); // siblings come together
  });

  it.each(habits.slice(0, 3))('shows who watches the pieces of a file, %s', async (_, how) => {
    const { files } = open(small().archive, how);
    await files.stored(ROOT, MOST); // the directory of the archive is there
    for (const name of [ROOT, tilePath({ level: 1, index: 1 })]) {
      const pieces: Uint8Array[] = [];
      const stored = await files.stored(name, MOST, { watch: (piece) => { pieces.push(piece.slice()); } });
      expect(Buffer.concat(pieces).equals(stored)).toBe(true);
    }
  });

  it('gives each tile of a large one', async () => {
    const opened = open(large());
    const { index, tree } = await directoryOf(opened);
    const { signal } = new AbortController();
    const all: Node[] = [];
    for (const next: Node[] = [{ level: 0, index: 0 }]; next.length > 0; ) {
      const children = tree.children(next.pop()!);
      all.push(...children);
      next.push(...children);
    }
    expect(all.length).toBeGreaterThan(1200);
    const chosen = all.filter((_, i) => i % 60 === 0);
    for (const node of chosen) {
      while (index.record(node) === null) await new Promise((resolve) => setTimeout(resolve, 1));
      const tile = await opened.remote.tile(node, index.record(node)!, signal);
      expect([tile.level, tile.index]).toEqual([node.level, node.index]);
    }
  }, 30_000);

  it('is read in the order of older archives, too', async () => {
    const { archive, directory } = small();
    const names = ['hierarchy.json', 'tiles.bin', 'outline.glb', 'preview.webp', 'tileset.json'];
    const tiles = readdirSync(path.join(directory, 'tiles'), { recursive: true, encoding: 'utf8' }).filter((name) => name.endsWith('.glb')).sort();
    expect(archive.length).toBeGreaterThan(0);
    const older = zipOf([...names, ...tiles.map((name) => `tiles/${name}`)].map((name) => ({ name, bytes: readFileSync(path.join(directory, name)) })));
    const opened = open(older);
    const { index } = await directoryOf(opened);
    const { signal } = new AbortController();
    for (const node of [{ level: 1, index: 0 }, { level: 2, index: 3 }]) {
      const tile = await opened.remote.tile(node, index.record(node)!, signal);
      expect([tile.level, tile.index]).toEqual([node.level, node.index]);
    }
    expect((await whole(opened.files, 'outline.glb', MOST)).length).toBe(statSync(path.join(directory, 'outline.glb')).size);
  });

  it('that has become another file is told', async () => {
    const { host, remote } = open(small().archive);
    await remote.manifest();
    host.tag = '"2"';
    await expect(remote.root()).rejects.toThrow('a.3tz: another model is there by now');
  });

  it('that has become shorter is told', async () => {
    const { archive } = small();
    const { host, files, remote } = open(archive, { hidesHeaders: true });
    await remote.manifest();
    host.file = archive.subarray(0, 6000);
    await expect(whole(files, 'tiles/01/000001.glb', MOST)).rejects.toThrow('a.3tz: ');
  });

  it.each([
    ['a page that says sorry', new TextEncoder().encode('<!doctype html><title>sorry</title>'), 'a.3tz: is no archive of a hierarchy'],
    ['nothing', new Uint8Array(0), 'a.3tz: the host answered 416'],
    ['another archive', zipOf([{ name: 'a.txt', bytes: Buffer.from('hello') }]), 'a.3tz: is no archive of a hierarchy'],
  ])('that is %s is refused', async (_, bytes, what) => {
    await expect(open(bytes).remote.manifest()).rejects.toThrow(what);
  });

  it('on a host that knows no ranges is refused if it is large', async () => {
    const { host, remote } = open(small().archive, { knowsNoRanges: true });
    host.next = (right) => new Response(right.body, { headers: { 'Content-Length': String(2 ** 27) } });
    await expect(remote.manifest()).rejects.toThrow('a.3tz: the host sends files whole, but no parts of them (HTTP ranges)');
    const endless = new ReadableStream<Uint8Array>({ pull: (stream) => { stream.enqueue(new Uint8Array(2 ** 22)); } });
    host.next = () => new Response(endless);
    await expect(remote.manifest()).rejects.toThrow('no parts of them (HTTP ranges)');
  });

  it('whose host sends another part is refused, and may be asked again', async () => {
    const { host, remote } = open(small().archive);
    await remote.manifest();
    host.next = (right) => new Response(right.body, { status: 206, headers: { 'Content-Range': 'bytes 0-9/100000' } });
    const problem: unknown = await remote.root().catch((thrown: unknown) => thrown);
    expect(problem).toMatchObject({ message: expect.stringContaining('something else than the part') as string, mayPass: true });
    expect((await remote.root()).level).toBe(0);
  });

  it('whose line breaks gives what has come, and the rest when it is asked again', async () => {
    const { archive } = small();
    const { host, remote } = open(archive);
    await remote.manifest();
    host.next = (right) => new Response(new Uint8Array(5), { status: 206, headers: right.headers });
    await expect(remote.root()).rejects.toThrow('a.3tz: broke off');
    expect((await remote.root()).level).toBe(0);
  });

  it('of which any byte is another one gives the same, or a problem that names a file', async () => {
    const { archive } = small();
    for (let at = 0; at < 40; ++at) {
      const bytes = archive.slice();
      bytes[Math.floor((at * 6000) / 40)] ^= 1 << (at % 8);
      const opened = open(bytes);
      await directoryOf(opened).catch((problem: unknown) => { expect(String(problem)).toMatch(/HierarchyProblem: (a\.3tz|hierarchy\.json|tiles)/); });
    }
  });

  it('ends what is no longer wanted, and no other', async () => {
    const opened = open(small().archive);
    const { index } = await directoryOf(opened);
    const [one, other] = [new AbortController(), new AbortController()];
    const left = opened.remote.tile({ level: 1, index: 0 }, index.record({ level: 1, index: 0 })!, one.signal);
    const right = opened.remote.tile({ level: 1, index: 1 }, index.record({ level: 1, index: 1 })!, other.signal);
    one.abort(new Error('not wanted'));
    await expect(left).rejects.toThrow('not wanted');
    expect((await right).index).toBe(1);
  });

  it('that was opened before is not fetched again, but for its beginning', async () => {
    const { archive } = small();
    const store = new FakeStore();
    const { signal } = new AbortController();
    const visit = async (tag: string): Promise<RangedHost> => {
      const host = new RangedHost(archive);
      host.tag = tag;
      const remote = new RemoteHierarchy(new RemoteArchive(URL_, host.fetch, store as unknown as CacheStorage), new TileDecoder(undefined, 0), signal);
      const manifest = await remote.manifest();
      const { index } = await remote.directory(manifest, await remote.root(), none, none);
      for (const node of [{ level: 1, index: 0 }, { level: 1, index: 1 }]) expect((await remote.tile(node, index.record(node)!, signal)).index).toBe(node.index);
      await remote.outline(manifest);
      return host;
    };
    expect((await visit('"1"')).asked.length).toBeGreaterThan(4);
    expect((await visit('"1"')).asked).toEqual(['0-16384']);
    expect((await visit('"2"')).asked.length).toBeGreaterThan(4); // another version
    expect(store.stores.size).toBe(1);
  });

  it('of which a store fails is fetched', async () => {
    const broken = { keys: () => Promise.reject(new Error('full')) } as unknown as CacheStorage;
    const host = new RangedHost(small().archive);
    const files = new RemoteArchive(URL_, host.fetch, broken);
    expect((await whole(files, 'outline.glb', MOST)).length).toBeGreaterThan(0);
  });

  it('takes what a directory takes, and two in a hundred at most', async () => {
    const { directory, archive } = small();
    const opened = open(archive);
    const { index, tree } = await directoryOf(opened);
    const { signal } = new AbortController();
    let bytes = ['hierarchy.json', 'tiles.bin', ROOT].reduce((sum, name) => sum + statSync(path.join(directory, name)).size, 0);
    for (const next: Node[] = tree.children({ level: 0, index: 0 }); next.length > 0; ) {
      const node = next.shift()!;
      await opened.remote.tile(node, index.record(node)!, signal);
      bytes += statSync(path.join(directory, tilePath(node))).size;
      next.push(...tree.children(node));
    }
    expect(opened.host.sentBytes).toBeLessThan(1.02 * bytes + 2 ** 14);
  });
});

/// As the browser's, as far as it is used.
class FakeStore {
  readonly stores = new Map<string, Map<string, Uint8Array<ArrayBuffer>>>();

  keys(): Promise<string[]> {
    return Promise.resolve([...this.stores.keys()]);
  }

  delete(name: string): Promise<boolean> {
    return Promise.resolve(this.stores.delete(name));
  }

  open(name: string): Promise<{ match(key: string): Promise<Response | undefined>; put(key: string, response: Response): Promise<void> }> {
    const files = this.stores.get(name) ?? new Map<string, Uint8Array<ArrayBuffer>>();
    this.stores.set(name, files);
    return Promise.resolve({
      match: (key) => Promise.resolve(files.has(key) ? new Response(files.get(key)) : undefined),
      put: async (key, response) => { files.set(key, new Uint8Array(await response.arrayBuffer())); },
    });
  }
}

/// An archive of stored files in that order.
function zipOf(files: readonly { name: string; bytes: Buffer }[]): Uint8Array<ArrayBuffer> {
  const pieces: Buffer[] = [];
  const central: Buffer[] = [];
  let at = 0;
  const offsets: number[] = [];
  const add = (name: string, bytes: Buffer): void => {
    const header = Buffer.alloc(30);
    header.writeUInt32LE(0x04034b50, 0);
    header.writeUInt16LE(10, 4);
    header.writeUInt32LE(bytes.length, 18);
    header.writeUInt32LE(bytes.length, 22);
    header.writeUInt16LE(name.length, 26);
    pieces.push(header, Buffer.from(name), bytes);
    const place = Buffer.alloc(46);
    place.writeUInt32LE(0x02014b50, 0);
    place.writeUInt32LE(at, 42);
    central.push(place, Buffer.from(name));
    offsets.push(at);
    at += archivedBytes(name, bytes.length);
  };
  for (const { name, bytes } of files) add(name, bytes);
  const index = Buffer.from(indexOf(files.map(({ name }) => name)));
  for (let i = 0; i < index.length; i += 24) index.writeBigUInt64LE(BigInt(offsets[Number(index.readBigUInt64LE(i + 16))]), i + 16);
  add('@3dtilesIndex1@', index);
  const directory = Buffer.concat(central);
  const end = Buffer.alloc(22);
  end.writeUInt32LE(0x06054b50, 0);
  end.writeUInt16LE(files.length + 1, 8);
  end.writeUInt16LE(files.length + 1, 10);
  end.writeUInt32LE(directory.length, 12);
  end.writeUInt32LE(at, 16);
  return new Uint8Array(Buffer.concat([...pieces, directory, end]));
}
