// SPDX-License-Identifier: MIT
// The files in an archive on any host that knows ranges (docs/file_format.md, section 8).
//
// An archive begins with the manifest, the root tile and the index of tiles: they are found from its beginning, and so is
// what follows them side by side. All else is found by the index of names at its end.
import { archivedBytes, beginsAsArchive, findInIndex, HEAD_BYTES, MOST_END_BYTES, MOST_LOCAL_BYTES, readEnd, readLocalHeader, type IndexPlace, type LocalHeader } from './archive_format.js';
import type { Asking, Fetch } from './bytes.js';
import { browserStore, KeptFiles } from './kept_files.js';
import { readManifest, type Manifest } from './manifest.js';
import { MANIFEST, MOST_MANIFEST_BYTES } from './manifest_file.js';
import { HierarchyProblem } from './problem.js';
import { RangedFile } from './ranged_file.js';
import type { RemoteFiles, FilePlace } from './files.js';
import { tilePath } from './tree.js';

/// Read of the end: index and directory of some 700 files.
const TAIL_BYTES = 2 ** 16;
/// Read of a file of unknown size.
const PEEK_BYTES = 2 ** 15;

const FIRST_TILE = tilePath({ level: 1, index: 0 });

interface Place {
  /// The first byte of the content.
  readonly offset: number;
  readonly bytes: number;
}

/// Bytes of the archive from `first` on.
interface Piece {
  readonly first: number;
  readonly bytes: Uint8Array;
}

interface Tail extends Piece {
  readonly index: IndexPlace;
}

/// The last path segment of a URL.
function nameOfUrl(url: string): string {
  return url.replace(/[?#].*$/, '').replace(/^.*\//, '');
}

/// What is read begins before the file.
function unwatched(init: Asking): Asking {
  return { ...init, watch: undefined };
}

export class RemoteArchive implements RemoteFiles {
  private readonly file: RangedFile;
  private readonly name: string;
  private readonly known = new Map<string, Place>();
  /// Where the header of the tile behind the root is; null: not known yet, or an older archive.
  private firstTile: number | null = null;
  private readonly started = new Map<string, Promise<unknown>>();
  private kept: KeptFiles | null = null;
  private isOpen = false;

  /// `store`: keeps files for the next visit; null: none does.
  constructor(
    private readonly url: string,
    private readonly fetch: Fetch,
    private readonly store: CacheStorage | null = browserStore(),
  ) {
    this.name = nameOfUrl(url);
    this.file = new RangedFile(url, this.name, fetch);
  }

  async stored(name: string, most: number, init: Asking = {}, where?: FilePlace): Promise<Uint8Array<ArrayBuffer>> {
    return this.fromVisits(name, () => (where === undefined ? this.contentOf(name, most, init) : this.contentAt(name, where, most, init)));
  }

  /// The host is asked again only where the page cannot see which version of the archive each answer is of.
  async manifestNow(signal: AbortSignal): Promise<Uint8Array<ArrayBuffer>> {
    const isSeen = this.isOpen && this.file.versionText !== null;
    const archive = this.isOpen && !isSeen ? new RemoteArchive(this.url, this.fetch, null) : this;
    return archive.contentOf(MANIFEST, MOST_MANIFEST_BYTES, { signal });
  }

  async part(name: string, [first, end]: [number, number], length: number, signal: AbortSignal): Promise<Uint8Array<ArrayBuffer>> {
    const place = await this.placeOf(name);
    if (place.bytes !== length) throw new HierarchyProblem(name, 'has another length than the manifest says');
    return this.fromVisits(`${name} ${first}-${end}`, () => this.file.read(place.offset + first, place.offset + end, { signal }));
  }

  /// From an earlier visit, of the same version; else `fetch` it, and keep it for a later one.
  private async fromVisits(name: string, fetch: () => Promise<Uint8Array<ArrayBuffer>>): Promise<Uint8Array<ArrayBuffer>> {
    await this.head();
    if (this.kept === null || name === MANIFEST) return fetch(); // that comes with the version
    const found = await this.kept.find(name);
    if (found !== null) return found;
    const bytes = await fetch();
    this.kept.keep(name, bytes);
    return bytes;
  }

  /// Once; what failed may be tried again.
  private once<T>(key: string, make: () => Promise<T>): Promise<T> {
    const started = this.started.get(key) as Promise<T> | undefined;
    if (started !== undefined) return started;
    const made = make();
    this.started.set(key, made);
    made.catch(() => this.started.delete(key));
    return made;
  }

  /// The beginning: with the manifest and the header behind it.
  private head(): Promise<Piece> {
    return this.once('head', async () => {
      let bytes = await this.file.readUpTo(0, HEAD_BYTES, { priority: 'high', cache: 'no-cache' });
      const first = beginsAsArchive(bytes) ? readLocalHeader(bytes, this.name) : null;
      if (first?.name !== MANIFEST || first.bytes > MOST_MANIFEST_BYTES)
        throw new HierarchyProblem(this.name, 'is no archive of a hierarchy: the host sent something else, or it is damaged');
      const end = first.headerBytes + first.bytes;
      if (bytes.length < end) bytes = await this.file.read(0, end + MOST_LOCAL_BYTES);
      this.note(first, 0);
      const version = this.file.versionText;
      if (version !== null && this.store !== null) this.kept = new KeptFiles(this.url, version, this.store);
      this.place(readManifest(new TextDecoder().decode(bytes.subarray(first.headerBytes, end))), bytes.subarray(end), end);
      this.isOpen = true;
      return { first: 0, bytes };
    });
  }

  /// Notes where the files behind the manifest lie. Older archives have another order: there they are looked up.
  private place({ index, outline, preview, objects }: Manifest, bytes: Uint8Array, from: number): void {
    const root = readLocalHeader(bytes, this.name);
    if (root?.name !== tilePath({ level: 0, index: 0 })) return;
    let at = from;
    const others = [index, outline, preview, objects].filter((file) => file !== null).map(({ file, bytes }) => ({ name: file, bytes, headerBytes: archivedBytes(file, 0) }));
    for (const file of [root, ...others]) {
      this.note(file, at);
      at += file.headerBytes + file.bytes;
    }
    this.firstTile = at;
  }

  private note({ name, bytes, headerBytes }: LocalHeader, at: number): Place {
    const place = { offset: at + headerBytes, bytes };
    this.known.set(name, place);
    return place;
  }

  private tail(): Promise<Tail> {
    return this.once('tail', async () => {
      const total = await this.file.size();
      const first = Math.max(0, total - TAIL_BYTES);
      const bytes = await this.file.read(first, total);
      return { first, bytes, index: readEnd(bytes.subarray(-MOST_END_BYTES), total, this.name) };
    });
  }

  /// Finds the local header of a file. Throws HierarchyProblem if there is no such file.
  private offsetOf(name: string): Promise<number> {
    return this.once(`offset of ${name}`, async () => {
      await this.head();
      if (this.firstTile !== null && name === FIRST_TILE) return this.firstTile;
      const [tail, { md5 }] = await Promise.all([this.tail(), import('@noble/hashes/legacy')]);
      const read = async (first: number, end: number): Promise<Uint8Array> =>
        first >= tail.first ? tail.bytes.subarray(first - tail.first, end - tail.first) : this.file.read(first, end);
      const offset = await findInIndex(md5(new TextEncoder().encode(name)), tail.index, read, this.name);
      if (offset === null) throw new HierarchyProblem(name, `is not in ${this.name}`);
      if (offset >= tail.index.offset) throw new HierarchyProblem(this.name, 'its index of files is damaged');
      return offset;
    });
  }

  private async placeOf(name: string): Promise<Place> {
    await this.head();
    const place = this.known.get(name);
    if (place !== undefined) return place;
    const at = await this.offsetOf(name);
    return this.note(this.headerOf(name, await this.file.read(at, at + archivedBytes(name, 0))), at);
  }

  /// `bytes` begin with it. Throws HierarchyProblem if it is of another file.
  private headerOf(name: string, bytes: Uint8Array): LocalHeader {
    const header = readLocalHeader(bytes, this.name);
    if (header?.name !== name) throw new HierarchyProblem(this.name, `has something else where ${name} should be: it is damaged, or has become another file`);
    return header;
  }

  /// Reads a file of any size.
  private async contentOf(name: string, most: number, init: Asking): Promise<Uint8Array<ArrayBuffer>> {
    const head = await this.head();
    const place = this.known.get(name);
    if (place !== undefined) return this.contentIn(place, head, name, most, init);
    const at = await this.offsetOf(name);
    const tail = await this.tail();
    const piece = { first: at, bytes: await this.file.read(at, Math.min(at + MOST_LOCAL_BYTES + PEEK_BYTES, tail.index.offset), unwatched(init)) };
    return this.contentIn(this.note(this.headerOf(name, piece.bytes), at), piece, name, most, init);
  }

  /// A content of which `piece` may have the beginning.
  private async contentIn({ offset, bytes }: Place, piece: Piece, name: string, most: number, init: Asking): Promise<Uint8Array<ArrayBuffer>> {
    if (bytes > most) throw new HierarchyProblem(name, `larger than ${most} bytes`);
    const there = piece.bytes.slice(offset - piece.first, offset - piece.first + bytes);
    init.watch?.(there);
    if (there.length === bytes) return there;
    const all = new Uint8Array(bytes);
    all.set(there);
    all.set(await this.file.read(offset + there.length, offset + bytes, init), there.length);
    return all;
  }

  /// Reads a file whose place and size are known.
  private async contentAt(name: string, { anchor, distance, bytes }: FilePlace, most: number, init: Asking): Promise<Uint8Array<ArrayBuffer>> {
    if (bytes > most) throw new HierarchyProblem(name, `larger than ${most} bytes`);
    const at = (await this.offsetOf(anchor)) + distance;
    const all = await this.file.read(at, at + archivedBytes(name, bytes), unwatched(init));
    const header = this.headerOf(name, all);
    if (header.bytes !== bytes) throw new HierarchyProblem(name, 'has another length than the index says');
    return all.subarray(header.headerBytes);
  }
}
