// A hierarchy at a URL: its root first, then what tells of the rest.
import { fetchBytes, fetchRange, type Fetch } from './bytes.js';
import { readManifest, type Manifest } from './manifest.js';
import type { Tile } from './tile.js';
import type { TileDecoder } from './tile_decoder.js';
import { TileIndex } from './tile_index.js';
import { Tree, tilePath, type Node } from './tree.js';

const MOST_MANIFEST = 2 ** 20;
const MOST_TILE = 2 ** 28;
const MOST_OUTLINE = 2 ** 20;

/// What all tiles but the root need.
export interface Directory {
  readonly manifest: Manifest;
  readonly tree: Tree;
  readonly index: TileIndex;
}

export class RemoteHierarchy {
  private readonly base: string;

  constructor(
    url: string,
    private readonly fetch: Fetch,
    private readonly decoder: TileDecoder,
  ) {
    this.base = url.replace(/\/*$/, '/');
  }

  async tile(node: Node, init: RequestInit = {}): Promise<Tile> {
    const path = tilePath(node);
    const bytes = await fetchBytes(this.fetch, this.base + path, path, MOST_TILE, init);
    return this.decoder.decode(bytes, path);
  }

  async outline(): Promise<Uint8Array> {
    return fetchBytes(this.fetch, `${this.base}outline.glb`, 'outline.glb', MOST_OUTLINE);
  }

  async manifest(): Promise<Manifest> {
    const text = await fetchBytes(this.fetch, `${this.base}hierarchy.json`, 'hierarchy.json', MOST_MANIFEST);
    return readManifest(new TextDecoder().decode(text));
  }

  /// With the beginning of the index; `onPage` and `onProblem` tell of the rest, which comes as it is looked into.
  async directory(manifest: Manifest, onPage: () => void, onProblem: (problem: unknown) => void): Promise<Directory> {
    const tree = new Tree(manifest.partitions);
    const read = (first: number, end: number): Promise<Uint8Array> => this.indexBytes(manifest, first, end);
    const index = new TileIndex(tree, manifest.place, read, onPage, onProblem);
    await index.open();
    return { manifest, tree, index };
  }

  private async indexBytes({ index: { file, bytes } }: Manifest, first: number, end: number): Promise<Uint8Array> {
    if (first === 0 && end === bytes) return fetchBytes(this.fetch, this.base + file, file, bytes);
    return fetchRange(this.fetch, this.base + file, file, [first, end], bytes);
  }
}
