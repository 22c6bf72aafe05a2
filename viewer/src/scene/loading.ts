// SPDX-License-Identifier: MIT
// Loads a view's hierarchy: one opening after the other, with the tiles that came, and the files that failed.
import type { Refined } from '../cut/refinement.js';
import { Refinement } from '../cut/refinement.js';
import { TileStore, type ResidentTile } from '../cut/tile_store.js';
import type { Fetch } from '../hierarchy/bytes.js';
import { letGo } from '../hierarchy/let_go.js';
import type { Manifest } from '../hierarchy/manifest.js';
import type { ObjectTable } from '../hierarchy/object_table.js';
import { HierarchyReplaced } from '../hierarchy/problem.js';
import { remoteFiles } from '../hierarchy/remote_files.js';
import type { Directory } from '../hierarchy/remote_hierarchy.js';
import type { Tile } from '../hierarchy/tile.js';
import { TileDecoder } from '../hierarchy/tile_decoder.js';
import type { TileRecord } from '../hierarchy/tile_index.js';
import { Tree, keyOf, type Node } from '../hierarchy/tree.js';
import { Opening, type FileHost } from './opening.js';
import { OutlineLayer } from './outline_layer.js';
import type { TileSource } from './surface.js';
import { memoryOf, mostMemory, texelBytesOf, vertexBytesOf } from './tile_object.js';
import type { View } from '../view/view_table.js';
import { isOnlyOnGpu } from './tile_texture.js';
import type { ViewContext } from './view_context.js';

const WORKERS = 2;
const REQUESTS = 6; // what browsers open to a host at once
const ROOT: Node = { level: 0, index: 0 };
const ROOT_KEY = keyOf(0, 0);

/// The cut that is shown of one opening.
export class ShownCut {
  /// Null: there is the root and no more.
  refinement: Refinement | null = null;
  state: Refined | null = null;
  /// Nothing else will come.
  isRootAll = false;
  /// The root is there but for its normal map.
  isEarly = false;
  isFirstFrame = true;
  /// Resolves once there is a picture of the root.
  rootDrawn!: () => void;
  readonly drawn = new Promise<void>((resolve) => { this.rootDrawn = resolve; });
}

export class Loading implements FileHost {
  manifest: Manifest | null = null;
  directory: Directory | null = null;
  objects: ObjectTable | null = null;
  cut = new ShownCut();
  store: TileStore;
  failed = 0;
  readonly decoder: TileDecoder;
  private readonly epochs = new Map<number, number>();
  private opening: Opening;
  private readonly missing = new Set<string | number>(); // files that failed and have not come since; tiles by their keys
  private isReplaced = false; // nothing more comes
  private hasLeft = false;
  private readonly outline: OutlineLayer;

  /// `url`: of the hierarchy's directory, or of its archive.
  constructor(private readonly url: string, private readonly context: ViewContext) {
    const { options } = context;
    this.decoder = new TileDecoder(options.createWorker, options.workers ?? WORKERS);
    this.opening = this.makeOpening(false);
    this.store = this.makeStore();
    this.outline = new OutlineLayer(context, this);
  }

  /// Resolves when the root can be drawn, perhaps before its normal map is there. Rejects with an Error that names the file.
  async open(): Promise<void> {
    return new Promise((resolve, reject) => { this.openRoot(resolve).then(resolve, reject); });
  }

  /// Begins anew, with what the host has now. Resolves and rejects as open() does.
  async reload(): Promise<void> {
    this.opening.close();
    this.store.freeze();
    this.opening = this.makeOpening(true);
    this.isReplaced = this.hasLeft = false;
    this.missing.clear();
    return this.open();
  }

  takeFirstView(build: string, view: View): void {
    if (this.manifest === null) return;
    this.manifest = { ...this.manifest, build, view };
    this.opening.remote.rename(build);
    this.context.changed();
  }

  /// Asks at once for what failed.
  retry(): void {
    if (this.isReplaced) return;
    const { root } = this.context.form;
    this.store.retry();
    this.opening.hurry();
    if (this.cut.isRootAll && root !== null) {
      const { isEarly } = this.cut;
      this.cut.isRootAll = false;
      if (isEarly) this.open().catch(() => undefined); // told already
      else void this.openDirectory(this.opening, root, this.opening.remote.manifest());
    }
    this.showOutline();
    this.context.changed();
  }

  /// Asks anew for what went with the device.
  askAgain(): void {
    this.store.dropLost(isOnlyOnGpu);
    this.context.changed();
  }

  /// It is fetched when it is first asked for, and where it belongs is known.
  showOutline(): void {
    const { directory, opening: { remote } } = this;
    if (directory !== null) this.outline.show(this.context.look.outline, () => remote.outline(directory.manifest), directory.manifest.place);
    this.context.changed();
  }

  /// The movement in which a tile was fetched.
  epochOf(key: number): number {
    return this.epochs.get(key) ?? 0;
  }

  /// Null until the manifest is there.
  get source(): TileSource | null {
    const { directory, opening: { remote } } = this;
    const load: TileSource['load'] = async (node, record, signal) => {
      try {
        return await remote.tile(node, record, signal);
      } catch (problem) {
        if (problem instanceof HierarchyReplaced && directory === this.directory) this.tell(keyOf(node.level, node.index), problem);
        throw problem;
      }
    };
    return directory && { ...directory, load };
  }

  /// A file failed: a tile by its key, others by their names.
  tell(file: string | number, problem: unknown): void {
    const { context } = this;
    if (context.ending.signal.aborted || this.isReplaced) return;
    if (problem instanceof HierarchyReplaced) {
      this.leave();
      return;
    }
    ++this.failed;
    this.missing.add(file);
    const message = problem instanceof Error ? problem.message : String(problem);
    context.events.dispatchEvent({ type: 'problem', message, files: this.missing.size });
    context.changed();
  }

  /// A file has come.
  recover(file: string | number): void {
    if (this.missing.delete(file) && this.missing.size === 0) this.context.events.dispatchEvent({ type: 'recovered' });
  }

  dispose(): void {
    this.opening.close();
    this.store.dispose();
    this.decoder.dispose();
    this.outline.clear();
  }

  private makeOpening(isAnew: boolean): Opening {
    const { options } = this.context;
    const fetch: Fetch = options.fetch ?? ((input, init) => globalThis.fetch(input, init));
    return new Opening(options.files ?? remoteFiles(this.url, fetch), this.decoder, this, isAnew);
  }

  private makeStore(): TileStore {
    const { remote } = this.opening;
    const { context } = this;
    const host = {
      load: (node: Node, record: TileRecord, signal: AbortSignal): Promise<Tile> => remote.tile(node, record, signal),
      bytesOf: (tile: Tile, seam: ResidentTile['seam']): number => memoryOf(tile, seam, context.look.wires),
      awaits: (key: number): boolean => context.tiles.awaits(key),
      came: (tile: ResidentTile): void => { this.came(tile); },
      gone: (tile: ResidentTile): void => {
        context.tiles.drop(tile);
        this.epochs.delete(tile.key);
      },
      failed: ({ level, index }: Node, problem: unknown): void => { this.tell(keyOf(level, index), problem); },
    };
    return new TileStore(host, () => this.directory!.tree, context.mostBytes, context.options.requests ?? REQUESTS);
  }

  /// Resolves when all of the root is there; `drawable` is called when a part of it can be drawn.
  private async openRoot(drawable: () => void): Promise<void> {
    const { opening } = this;
    const manifest = opening.remote.manifest();
    manifest.catch(() => undefined); // told when it is needed
    const showEarly = (early: Tile): void => {
      if (opening.isClosed) {
        letGo(early);
        return;
      }
      this.showRoot(early);
      this.cut.isEarly = true;
      drawable();
    };
    let root: Tile;
    try {
      root = await opening.root(showEarly);
    } catch (problem) {
      if (problem instanceof HierarchyReplaced && !opening.isAnew) return this.reload(); // nothing was seen of it
      if (this.cut.isEarly && !opening.isClosed) this.leaveEarly(problem);
      throw problem;
    }
    if (this.cut.isEarly) await this.context.tiles.compiled;
    if (opening.isClosed) {
      letGo(root);
      return;
    }
    this.showRoot(root);
    void this.openDirectory(opening, root, manifest, this.cut.drawn);
  }

  /// Instead of what was shown before, if there was anything.
  private showRoot(root: Tile): void {
    const { context } = this;
    if (context.form.root !== null) this.forget();
    context.form.takeRoot(root, context.standing);
    context.tiles.hasNormalMaps = root.tangents !== null;
    context.tiles.show([this.store.addRoot(root, new Tree(1))], context.look);
    context.changed();
  }

  /// The normal map does not come: nobody awaits it any longer.
  private leaveEarly(problem: unknown): void {
    this.tell('root', problem);
    this.cut.isRootAll = true;
    this.context.changed();
  }

  /// All of an earlier opening; the manifest stays until there is another one.
  private forget(): void {
    this.store.dispose();
    this.store = this.makeStore();
    this.outline.clear();
    this.directory = null;
    this.cut = new ShownCut();
  }

  /// Without it there is the root and no more. `early`: the manifest was asked for already. `drawn`: once there is a picture of the root.
  private async openDirectory(opening: Opening, root: Tile, early: Promise<Manifest>, drawn?: Promise<void>): Promise<void> {
    try {
      this.begin(await opening.directory({ root, early, drawn }, () => { this.context.changed(); }), root);
    } catch (problem) {
      if (opening.isClosed) return;
      if (problem instanceof HierarchyReplaced && !opening.isAnew) {
        this.reload().catch((failure: unknown) => { this.tell('root', failure); }); // nothing but the root was seen of it
        return;
      }
      this.tell('directory', problem);
      this.cut.isRootAll = true;
      this.context.changed();
    }
  }

  private begin(directory: Directory, root: Tile): void {
    const { manifest, tree, index } = directory;
    const { context } = this;
    this.directory = directory;
    this.manifest = manifest;
    this.objects = this.opening.remote.objects(manifest);
    context.form.takeManifest(manifest);
    context.takeFirst(manifest.view);
    context.tiles.hasNormalMaps = manifest.hasNormalMaps;
    const [vertexBytes, texelBytes] = [vertexBytesOf(root), texelBytesOf(root)];
    this.cut.refinement = new Refinement(tree, index, this.store, (record, { level }) =>
      mostMemory(record, { level, vertexBytes, wires: context.look.wires, texelBytes }));
    context.account.fetched(index.record(ROOT)!.bytes);
    this.showOutline();
    context.changed();
  }

  private came(resident: ResidentTile): void {
    const { key, node } = resident;
    const { account, tiles, look } = this.context;
    if (key !== ROOT_KEY) tiles.take(resident, look);
    this.epochs.set(key, account.epoch);
    this.recover(key);
    const record = this.directory?.index.record(node);
    if (record) account.fetched(record.bytes);
    this.context.wake();
  }

  /// The host has another build. What was fetched fits together; nothing more of it will come.
  private leave(): void {
    if (this.hasLeft) return;
    const isLasting = this.opening.remote.leaveHost();
    this.hasLeft = true;
    this.isReplaced = !isLasting;
    this.missing.clear();
    if (!isLasting) {
      this.opening.close();
      this.store.freeze();
    }
    this.context.events.dispatchEvent({ type: 'replaced', isLasting });
    this.context.changed();
  }
}
