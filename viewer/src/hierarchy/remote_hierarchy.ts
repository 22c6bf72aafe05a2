// SPDX-License-Identifier: MIT
// A hierarchy at a URL: its root first, then what tells of the rest.
import { Build } from './build.js';
import { checksum } from './checksum.js';
import { fetchManifest, type Manifest } from './manifest.js';
import type { TableFacts } from './object_facts.js';
import { ObjectTable } from './object_table.js';
import { fetchOutlineOf, type Outline } from './outline.js';
import { HierarchyProblem, HierarchyReplaced } from './problem.js';
import { letGo } from './let_go.js';
import { MOST_SIDE } from './limits.js';
import { mostPictureBytes } from './picture.js';
import { whole, type RemoteFiles } from './files.js';
import { fits, type Seal } from './seal.js';
import type { OpenedTile } from './stored_tile.js';
import type { NormalSource, Tile } from './tile.js';
import { TileBeginning } from './tile_beginning.js';
import type { ExpectedCounts } from './tile_counts.js';
import type { TileDecoder } from './tile_decoder.js';
import { TileIndex, type TileRecord } from './tile_index.js';
import { Tree, tilePath, type Node } from './tree.js';

/// A root has 32,768 vertices at the most, seldom more than twice as many triangles, a picture and a normal map.
const MOST_ROOT = 2 ** 25 + 2 * mostPictureBytes({ width: MOST_SIDE, height: MOST_SIDE });
const ROOT: Node = { level: 0, index: 0 };

/// A tile's table of objects has 4 MiB of columns, and at least one number a vertex, besides the row of each vertex.
function mostTableBytes(record: TileRecord): number {
  return 2 ** 22 + 2 ** 16 + 8 * (record.own + record.ghosts + record.copies + record.splits);
}

/// All tiles but the root need this.
export interface Directory {
  readonly manifest: Manifest;
  readonly tree: Tree;
  readonly index: TileIndex;
}

/// Bytes of a tile's file, out of its gzip, at the most: with all attributes, raw ones too, and the widest indices.
function mostBytes(record: TileRecord, level: number): number {
  const { own, ghosts, copies, splits, interior, border, pictureWidth: width, pictureHeight: height, hasNormalMap } = record;
  const perVertex = 2 * (12 + 16 + 8) + 12 + 8;
  const perGhost = 2 * level + 8;
  const perSplit = 12 + 12 + 16 + 8 + 8 + 4; // nothing raw
  const vertices = perVertex * (own + ghosts + copies) + 4 * copies + perSplit * splits;
  return vertices + 12 * (interior + border) + 2 * own + perGhost * ghosts + 2 * 65536 + (hasNormalMap ? 2 : 1) * mostPictureBytes({ width, height });
}

function expectedOf({ level, index }: Node, record: TileRecord): ExpectedCounts {
  const { own, ghosts, copies, splits, interior, border, pictureWidth, pictureHeight, hasNormalMap } = record;
  return { level, index, own, ghosts, copies, splits, interior, border, pictureWidth, pictureHeight, hasNormalMap };
}

export class RemoteHierarchy {
  private normalsFrom: NormalSource | null = null;
  private index: TileIndex | null = null;
  private build: Build | null = null;
  private packedTiles = false;
  private hasObjects = false;
  private rootBytes: Uint8Array | null = null; // as they came, until it is known what they should be

  /// `signal`: ends all that is under way. `isAnew`: what caches have is of an earlier build, perhaps.
  constructor(
    private readonly files: RemoteFiles,
    private readonly decoder: TileDecoder,
    private readonly signal: AbortSignal,
    private readonly isAnew = false,
  ) {}

  /// `early`: is given the root without its normal map, which takes most of the bytes, if all else comes noticeably before; whoever is given it
  /// owns it. The root that is returned is another one.
  async root(early?: (root: Tile) => void): Promise<Tile> {
    const name = tilePath(ROOT);
    let isWhole = false;
    const showEarly = (bytes: Uint8Array<ArrayBuffer>): void => {
      this.decodeRoot(bytes, true).then((root) => { if (isWhole) letGo(root); else early?.(root); }, () => undefined); // what is wrong is told of the whole file
    };
    const watch = early && new TileBeginning(name, (bytes) => { if (!isWhole) showEarly(bytes); }).take;
    const bytes = await this.files.stored(name, MOST_ROOT, { priority: 'high', signal: this.signal, watch, ...(this.isAnew && { cache: 'reload' as const }) });
    isWhole = true;
    const tile = await this.decodeRoot(bytes);
    this.normalsFrom = tile.normalsFrom;
    this.rootBytes = bytes;
    return tile;
  }

  private async decodeRoot(bytes: Uint8Array<ArrayBuffer>, isBeginning = false): Promise<Tile> {
    const name = tilePath(ROOT);
    const { tile } = await this.decoder.decode(bytes, { name, most: MOST_ROOT, expected: null, seal: null, isBeginning });
    if (tile.level !== 0 || tile.index !== 0 || tile.ghosts !== 0) throw new HierarchyProblem(name, 'not a root');
    return tile;
  }

  /// After the directory. `record`: what the index says of it; a tile that is another one is refused. Throws HierarchyReplaced where it is of
  /// another build.
  async tile(node: Node, record: TileRecord, signal: AbortSignal): Promise<Tile> {
    try {
      return await this.checkedTile(node, record, signal);
    } catch (problem) {
      throw await this.explained(problem, this.holds(tilePath(node)));
    }
  }

  /// Call it once the directory is there.
  async outline(manifest: Manifest): Promise<Outline> {
    try {
      return await fetchOutlineOf(manifest, this.files, this.signal);
    } catch (problem) {
      throw await this.explained(problem);
    }
  }

  /// Names and properties of objects, read as they are asked for; null: there are none. Call it once the directory is there.
  objects({ objects }: Manifest): ObjectTable | null {
    const open = (facts: TableFacts, words: ObjectTable | null = null): ObjectTable => new ObjectTable(facts, async (first, end) => {
      try {
        return await this.files.part(facts.file, [first, end], facts.bytes, this.signal);
      } catch (problem) {
        throw await this.explained(problem, this.holds(facts.file, end));
      }
    }, words);
    return objects && open(objects, objects.words && open(objects.words));
  }

  async manifest(): Promise<Manifest> {
    return fetchManifest(this.files, this.signal);
  }

  /// The build has another name from now on, and the same files but for its manifest.
  rename(name: string): void {
    this.files.setBuild?.(name);
    if (this.build !== null) this.build.name = name;
  }

  /// The host has another build by now: what it has is left out. False: then there is nothing.
  leaveHost(): boolean {
    return this.files.leaveHost?.() ?? false;
  }

  /// With the beginning of the index; `onPage` and `onProblem` tell of the rest, which comes as it is looked into. `root`
  /// must be the tile that the index has for it; if it has to be fetched again, that waits for `drawn`. Throws HierarchyReplaced where it is of another build.
  async directory(manifest: Manifest, root: Tile, onPage: () => void, onProblem: (problem: unknown) => void, drawn?: Promise<void>): Promise<Directory> {
    this.build = new Build(this.files, manifest.build, this.signal);
    this.packedTiles = manifest.packedTiles;
    this.hasObjects = manifest.objects !== null;
    const tree = new Tree(manifest.partitions);
    const read = (first: number, end: number): Promise<Uint8Array> => this.indexBytes(manifest, first, end);
    const index = new TileIndex(tree, manifest.place, read, onPage, onProblem, (node) => this.files.lacks?.(tilePath(node)) ?? false);
    await index.open();
    const record = index.record(ROOT);
    if (record !== null) await this.checkRoot(record, drawn);
    if (record?.own !== root.own || record.interior !== root.interiorCount || record.pictureWidth !== ((root.picture ?? root.normalMap)?.width ?? 0))
      throw new HierarchyProblem(tilePath(ROOT), 'not the tile that the index tells of');
    this.index = index;
    this.files.setBuild?.(manifest.build);
    return { manifest, tree, index };
  }

  private async checkedTile(node: Node, record: TileRecord, signal: AbortSignal): Promise<Tile> {
    const name = tilePath(node);
    const most = mostBytes(record, node.level) + (this.hasObjects ? mostTableBytes(record) : 0);
    const seal = this.holds(name) ? null : this.sealOf(record);
    const bytes = await this.files.stored(name, most, { signal }, this.index?.whereabouts(node) ?? undefined);
    const opened = await this.decoder.decode(bytes, { name, most, expected: expectedOf(node, record), seal });
    try {
      await this.checkOpened(opened, name, seal);
    } catch (problem) {
      letGo(opened.tile);
      throw problem;
    }
    return opened.tile;
  }

  private async checkOpened({ tile, isSealed }: OpenedTile, name: string, seal: Seal | null): Promise<void> {
    if (seal !== null && !isSealed) await this.build?.confirm();
    if (tile.normalsFrom !== this.normalsFrom) throw new HierarchyProblem(name, 'its normals are not of the kind that the root has');
  }

  /// It came before anything told what it should be. A cache may have had it of an earlier build: then all begins anew.
  private async checkRoot(record: TileRecord, drawn?: Promise<void>): Promise<void> {
    const { rootBytes: bytes } = this;
    this.rootBytes = null;
    const name = tilePath(ROOT);
    if (bytes === null || this.holds(name)) return;
    const isFitting = fits(bytes, checksum(bytes), this.sealOf(record)) ?? (await this.isStillRoot(bytes, drawn));
    if (isFitting) return;
    throw this.isAnew ? await this.explained(new HierarchyProblem(name, 'its size or checksum is not that of the index: it is damaged')) : new HierarchyReplaced(name);
  }

  /// Tells whether a root that a host has unpacked is what the host has now, and the build still the same.
  private async isStillRoot(bytes: Uint8Array, drawn?: Promise<void>): Promise<boolean> {
    await drawn;
    const now = await this.files.stored(tilePath(ROOT), MOST_ROOT, { cache: 'no-cache', signal: this.signal });
    await this.build?.confirm();
    return now.length === bytes.length && checksum(now) === checksum(bytes);
  }

  private async indexBytes(manifest: Manifest, first: number, end: number): Promise<Uint8Array> {
    const { file, bytes } = manifest.index;
    const isWhole = first === 0 && end === bytes;
    try {
      const read = isWhole ? await whole(this.files, file, bytes, { signal: this.signal }) : await this.files.part(file, [first, end], bytes, this.signal);
      if (!this.holds(file, end)) await this.checkIndex(read, manifest);
      return read;
    } catch (problem) {
      throw await this.explained(problem, this.holds(file, end));
    }
  }

  /// A part of it has no checksum: it is of this build if the host still has that.
  private async checkIndex(read: Uint8Array, { index: { file, bytes, checksum: sum } }: Manifest): Promise<void> {
    if (read.length < bytes) await this.build?.confirm();
    else if (checksum(read) !== sum) throw new HierarchyProblem(file, 'its checksum is not that of the manifest: it is damaged, or of another build');
  }

  private holds(name: string, end?: number): boolean {
    return this.files.holds?.(name, end) ?? false;
  }

  private sealOf({ bytes, checksum: sum }: TileRecord): Seal {
    return { bytes, checksum: sum, isPacked: this.packedTiles };
  }

  /// `isHeld`: no host has to do with it.
  private explained(problem: unknown, isHeld = false): Promise<unknown> {
    return isHeld || this.build === null ? Promise.resolve(problem) : this.build.explain(problem);
  }
}
