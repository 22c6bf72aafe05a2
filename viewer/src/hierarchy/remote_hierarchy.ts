// SPDX-License-Identifier: MIT
// A hierarchy at a URL: its root first, then what tells of the rest.
import { fetchManifest, type Manifest } from './manifest.js';
import { fetchOutline, type Outline } from './outline.js';
import { HierarchyProblem } from './problem.js';
import { MOST_SIDE } from './limits.js';
import { mostPictureBytes } from './picture.js';
import type { RemoteFiles } from './remote_files.js';
import { letGo, type NormalSource, type Tile } from './tile.js';
import type { ExpectedCounts } from './tile_counts.js';
import type { TileDecoder } from './tile_decoder.js';
import { TileIndex, type TileRecord } from './tile_index.js';
import { Tree, tilePath, type Node } from './tree.js';

/// A root has 32,768 vertices at the most, seldom more than twice as many triangles, and a picture.
const MOST_ROOT = 2 ** 25 + mostPictureBytes({ width: MOST_SIDE, height: MOST_SIDE });
const ROOT: Node = { level: 0, index: 0 };

/// What all tiles but the root need.
export interface Directory {
  readonly manifest: Manifest;
  readonly tree: Tree;
  readonly index: TileIndex;
}

/// Bytes of a tile's file, out of its gzip, at the most: with all attributes, raw ones too, and the widest indices.
function mostBytes(record: TileRecord, level: number): number {
  const { own, ghosts, copies, splits, interior, border, pictureWidth: width, pictureHeight: height } = record;
  const perVertex = 2 * (12 + 16 + 8) + 12 + 8;
  const perGhost = 2 * level + 8;
  const perSplit = 12 + 12 + 16 + 8 + 8 + 4; // nothing raw
  const vertices = perVertex * (own + ghosts + copies) + 4 * copies + perSplit * splits;
  return vertices + 12 * (interior + border) + 2 * own + perGhost * ghosts + 2 * 65536 + mostPictureBytes({ width, height });
}

function expectedOf({ level, index }: Node, record: TileRecord): ExpectedCounts {
  const { own, ghosts, copies, splits, interior, border, pictureWidth, pictureHeight } = record;
  return { level, index, own, ghosts, copies, splits, interior, border, pictureWidth, pictureHeight };
}

export class RemoteHierarchy {
  private normalsFrom: NormalSource | null = null;
  private index: TileIndex | null = null;

  /// `signal`: ends all that is under way.
  constructor(
    private readonly files: RemoteFiles,
    private readonly decoder: TileDecoder,
    private readonly signal: AbortSignal,
  ) {}

  async root(): Promise<Tile> {
    const path = tilePath(ROOT);
    const bytes = await this.files.whole(path, MOST_ROOT, { priority: 'high', signal: this.signal });
    const tile = await this.decoder.decode(bytes, path, null);
    if (tile.level !== 0 || tile.index !== 0 || tile.ghosts !== 0) throw new HierarchyProblem(path, 'not a root');
    this.normalsFrom = tile.normalsFrom;
    return tile;
  }

  /// After the root. `record`: what the index says of it; a tile that is another one is refused.
  async tile(node: Node, record: TileRecord, signal: AbortSignal): Promise<Tile> {
    const path = tilePath(node);
    const bytes = await this.files.whole(path, mostBytes(record, node.level), { signal }, this.index?.whereabouts(node) ?? undefined);
    const tile = await this.decoder.decode(bytes, path, expectedOf(node, record));
    if (tile.normalsFrom === this.normalsFrom) return tile;
    letGo(tile);
    throw new HierarchyProblem(path, 'its normals are not of the kind that the root has');
  }

  async outline(): Promise<Outline> {
    return fetchOutline(this.files, this.signal);
  }

  async manifest(): Promise<Manifest> {
    return fetchManifest(this.files, this.signal);
  }

  /// With the beginning of the index; `onPage` and `onProblem` tell of the rest, which comes as it is looked into. `root`
  /// must be the tile that the index has for it.
  async directory(manifest: Manifest, root: Tile, onPage: () => void, onProblem: (problem: unknown) => void): Promise<Directory> {
    const tree = new Tree(manifest.partitions);
    const read = (first: number, end: number): Promise<Uint8Array> => this.indexBytes(manifest, first, end);
    const index = new TileIndex(tree, manifest.place, read, onPage, onProblem, (node) => this.files.lacks?.(tilePath(node)) ?? false);
    await index.open();
    this.index = index;
    const record = index.record(ROOT);
    if (record?.own !== root.own || record.interior !== root.interiorCount || record.pictureWidth !== ((root.picture ?? root.normalMap)?.width ?? 0))
      throw new HierarchyProblem(tilePath(ROOT), 'not the tile that the index tells of');
    return { manifest, tree, index };
  }

  private async indexBytes({ index: { file, bytes } }: Manifest, first: number, end: number): Promise<Uint8Array> {
    if (first === 0 && end === bytes) return this.files.whole(file, bytes, { signal: this.signal });
    return this.files.part(file, [first, end], bytes, this.signal);
  }
}
