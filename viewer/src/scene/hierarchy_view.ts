// SPDX-License-Identifier: MIT
// A hierarchy as an object of a three scene: loads what the view needs, draws one cut without cracks.
import { Box3, Group, Vector3, type Matrix4, type PerspectiveCamera } from 'three';
import type { ChosenNode } from '../cut/choose_cut.js';
import { FrameRate } from '../cut/frame_rate.js';
import { Refinement, type Refined } from '../cut/refinement.js';
import { PAUSE_MS } from '../cut/rest_detail.js';
import { TileStore, type ResidentTile } from '../cut/tile_store.js';
import type { Vector, Viewpoint } from '../cut/viewpoint.js';
import type { Fetch } from '../hierarchy/bytes.js';
import { directionOf } from '../hierarchy/first_view.js';
import type { Manifest } from '../hierarchy/manifest.js';
import { HierarchyProblem, HierarchyReplaced } from '../hierarchy/problem.js';
import { remoteFiles } from '../hierarchy/remote_files.js';
import type { Directory } from '../hierarchy/remote_hierarchy.js';
import type { Tile } from '../hierarchy/tile.js';
import { TileDecoder } from '../hierarchy/tile_decoder.js';
import type { TileRecord } from '../hierarchy/tile_index.js';
import { Tree, keyOf, tilePath, type Node } from '../hierarchy/tree.js';
import { Account } from './account.js';
import { Alarm } from './alarm.js';
import { modeOf } from './mode.js';
import { Opening } from './opening.js';
import { OutlineLayer } from './outline_layer.js';
import { Motion, REST_MS, viewpointOf, type Viewport } from './motion.js';
import { changedSettings, DEFAULT_LOOK, type Look, type Mode, type Settings, type Stats } from './settings.js';
import { changedStanding, DEFAULT_STANDING, upwards, type Standing } from './standing.js';
import { silhouetteOf } from './silhouette.js';
import { terrainOf, type Terrain } from './terrain.js';
import { memoryOf, mostMemory, texelBytesOf, vertexBytesOf } from './tile_object.js';
import type { DrawnTile, TileSource } from './surface.js';
import { TileScene } from './tile_scene.js';
import { isOnlyOnGpu } from './tile_texture.js';
import type { ViewEvents, ViewOptions } from './view_options.js';

const WORKERS = 2;
const REQUESTS = 6; // what browsers open to a host at once
const LONGEST_FRAME_MS = 5000; // a longer one was no frame: the page slept
const RETRY_MS = 1000;
const ROOT: Node = { level: 0, index: 0 };
const ROOT_KEY = keyOf(0, 0);

function saysColour({ colours }: Tile): boolean {
  return colours?.some((value) => value < 255) ?? false;
}

export class HierarchyView extends Group<ViewEvents> {
  /// Resolves when the root can be drawn: after one request. Rejects with an Error that names the file.
  readonly opened: Promise<void>;
  /// Of the model, upright, in the coordinates of this group.
  readonly box = new Box3();
  manifest: Manifest | null = null;
  /// What the mesh is like as a terrain, as it stands; null: it is none, or not known yet.
  terrain: Terrain | null = null;

  private currentSettings: Settings;
  private currentLook: Look;
  private currentStanding: Standing;
  /// Of the model, in the tiles' coordinates: smallest, then largest.
  private corners: readonly number[] = [];
  private readonly decoder: TileDecoder;
  private opening: Opening;
  private store: TileStore;
  private readonly tiles = new TileScene(() => { this.askAgain(); });
  private readonly account = new Account();
  private readonly rate: FrameRate;
  private readonly motion = new Motion();
  private readonly epochs = new Map<number, number>();
  private directory: Directory | null = null;
  private refinement: Refinement | null = null;
  private isCutOpen = false;
  private drawn: readonly ChosenNode[] = [];
  private viewpoint: Viewpoint | null = null;
  private pixels = 1;
  private state: Refined | null = null;
  private isDirty = false;
  private isAwake = false;
  private wasMoving = false;
  private lastFrame = 0;
  private failed = 0;
  private isReplaced = false; // nothing more comes
  private hasLeft = false;
  private readonly missing = new Set<string | number>(); // files that failed and have not come since; tiles by their keys
  private readonly alarm = new Alarm(() => { this.wake(); });
  private readonly ending = new AbortController();
  private root: Tile | null = null;
  /// x, y, z of points of its outline, in the tiles' coordinates.
  private silhouette: Float32Array = new Float32Array(0);
  /// Nothing else will come.
  private isRootAll = false;
  private isFirstFrame = true;
  private rootDrawn = (): void => undefined;
  private readonly outline = new OutlineLayer(this.tiles, { tell: (problem) => { this.tell('outline', problem); }, came: () => { this.recover('outline'); this.changed(); } });

  /// `url`: of the hierarchy's directory, or of its archive.
  constructor(private readonly url: string, private readonly options: ViewOptions = {}) {
    super();
    this.currentSettings = changedSettings(options.settings ?? {});
    this.currentLook = { ...DEFAULT_LOOK, ...options.look };
    this.currentStanding = changedStanding(options.standing ?? {}, DEFAULT_STANDING);
    this.decoder = new TileDecoder(options.createWorker, options.workers ?? WORKERS);
    this.opening = this.makeOpening(false);
    this.rate = new FrameRate(this.settings.framesPerSecond);
    this.store = this.makeStore();
    this.add(this.tiles);
    this.opened = this.open();
    this.opened.catch(() => undefined); // whoever waits is told; nobody must
    globalThis.addEventListener?.('online', () => { this.retry(); }, { signal: this.ending.signal });
  }

  /// Begins anew, with what the host has now: as after `replaced`. What is seen stays until the root has come, and how it is looked at stays.
  /// Resolves and rejects as `opened` does.
  async reload(): Promise<void> {
    this.opening.close();
    this.store.freeze();
    this.opening = this.makeOpening(true);
    this.isReplaced = this.hasLeft = false;
    this.missing.clear();
    return this.open();
  }

  get settings(): Readonly<Settings> {
    return this.currentSettings;
  }

  get look(): Readonly<Look> {
    return this.currentLook;
  }

  setSettings(change: Partial<Settings>): void {
    this.currentSettings = changedSettings(change, this.currentSettings);
    this.rate.target = this.settings.framesPerSecond;
    this.store.budget = this.settings.memoryBudget;
    this.changed();
  }

  setLook(change: Partial<Look>): void {
    this.currentLook = { ...this.currentLook, ...change };
    this.store.recount();
    this.showOutline();
    this.changed();
  }

  get standing(): Readonly<Standing> {
    return this.currentStanding;
  }

  /// `box` is another one afterwards.
  setStanding(change: Partial<Standing>): void {
    this.currentStanding = changedStanding(change, this.currentStanding);
    if (this.root !== null) this.stand(this.root);
    this.changed();
  }

  /// Which way is up as the mesh stands, in its own coordinates.
  get upwards(): Vector {
    return upwards(this.standing.up, this.root?.zUp ?? false);
  }

  /// From where the model is looked at first: to the viewer, of length 1, in the coordinates of this group. Null: not known yet, an older
  /// hierarchy does not say it, or the mesh stands on another axis.
  get firstDirection(): Vector | null {
    const { root, standing: { up } } = this;
    if (root?.firstView == null) return null;
    return up === 'file' || up === (root.zUp ? 'z' : 'y') ? directionOf(root.firstView) : null;
  }

  /// Points of the root's outline from all sides, as they stand in this group, in one and the same vector. None: not known yet.
  *shape(): Iterable<Vector3> {
    const point = new Vector3();
    for (let i = 0; i < this.silhouette.length; i += 3) yield point.fromArray(this.silhouette, i).applyMatrix4(this.tiles.matrix);
  }

  /// Whether the mesh has colours or pictures of its own; those that are white everywhere say nothing. Null: not known yet.
  get hasColours(): boolean | null {
    return this.root && (this.root.picture !== null || saysColour(this.root));
  }

  /// Whether vertices have something besides normals, colours and texture coordinates; null: not known yet.
  get hasAttributes(): boolean | null {
    return this.root && this.root.values !== null;
  }

  /// Whether the mesh has triangles, and not only points; null: not known yet.
  get hasTriangles(): boolean | null {
    return this.root && this.root.indices.length > 0;
  }

  /// Fetched when it is first asked for, and where it belongs is known.
  private showOutline(): void {
    const { directory, opening: { remote } } = this;
    if (directory !== null) this.outline.show(this.look.outline, () => remote.outline(directory.manifest), directory.manifest.place);
    this.changed();
  }

  // ---- opening

  private makeOpening(isAnew: boolean): Opening {
    const fetch: Fetch = this.options.fetch ?? ((input, init) => globalThis.fetch(input, init));
    const host = { tell: (file: string, problem: unknown) => { this.tell(file, problem); }, recover: (file: string) => { this.recover(file); } };
    return new Opening(this.options.files ?? remoteFiles(this.url, fetch), this.decoder, host, isAnew);
  }

  private makeStore(): TileStore {
    const { remote } = this.opening;
    const host = {
      load: (node: Node, record: TileRecord, signal: AbortSignal): Promise<Tile> => remote.tile(node, record, signal),
      bytesOf: (tile: Tile, seam: ResidentTile['seam']): number => memoryOf(tile, seam, this.look.wires),
      came: (tile: ResidentTile): void => { this.came(tile); },
      gone: (tile: ResidentTile): void => {
        this.tiles.drop(tile);
        this.epochs.delete(tile.key);
      },
      failed: ({ level, index }: Node, problem: unknown): void => { this.tell(keyOf(level, index), problem); },
    };
    return new TileStore(host, () => this.directory!.tree, this.settings.memoryBudget, this.options.requests ?? REQUESTS);
  }

  private async open(): Promise<void> {
    const { opening } = this;
    const manifest = opening.remote.manifest();
    manifest.catch(() => undefined); // told when it is needed
    let root: Tile;
    try {
      root = await opening.root();
    } catch (problem) {
      if (problem instanceof HierarchyReplaced && !opening.isAnew) return this.reload(); // nothing was seen of it
      throw problem;
    }
    if (this.root !== null) this.forget();
    this.root = root;
    this.silhouette = silhouetteOf(root);
    this.tiles.insideOut = root.insideOut;
    this.corners = root.box;
    this.stand(root);
    this.tiles.show([this.store.addRoot(root, new Tree(1))], this.look);
    this.changed();
    void this.openDirectory(opening, root, manifest, new Promise((resolve) => { this.rootDrawn = resolve; }));
  }

  /// All of an earlier opening; the manifest stays until there is another one.
  private forget(): void {
    this.store.dispose();
    this.store = this.makeStore();
    this.outline.clear();
    this.directory = this.refinement = this.state = null;
    this.drawn = [];
    this.isRootAll = false;
    this.isFirstFrame = true;
  }

  /// Upright, as it is wished.
  private stand(root: Tile): void {
    const up = upwards(this.standing.up, root.zUp);
    this.terrain = terrainOf(root, up);
    this.tiles.stand(this.standing, root, this.terrain?.along ?? up);
    this.setBox();
  }

  private setBox(): void {
    const [a, b, c, d, e, f] = this.corners;
    this.box.set(new Vector3(a, b, c), new Vector3(d, e, f)).applyMatrix4(this.tiles.matrix);
  }

  /// Without it there is the root and no more. `early`: the manifest was asked for already. `drawn`: once there is a picture of the root.
  private async openDirectory(opening: Opening, root: Tile, early: Promise<Manifest>, drawn?: Promise<void>): Promise<void> {
    try {
      this.begin(await opening.directory({ root, early, drawn }, () => { this.changed(); }), root);
    } catch (problem) {
      if (opening.isClosed) return;
      if (problem instanceof HierarchyReplaced && !opening.isAnew) {
        this.reload().catch((failure: unknown) => { this.tell('root', failure); }); // nothing but the root was seen of it
        return;
      }
      this.tell('directory', problem);
      this.isRootAll = true;
      this.changed();
    }
  }

  private begin(directory: Directory, root: Tile): void {
    const { manifest, tree, index } = directory;
    this.directory = directory;
    this.manifest = manifest;
    const corner = (from: readonly number[]): number[] => from.map((x, axis) => x - manifest.origin[axis] - manifest.place[axis]);
    this.corners = [...corner(manifest.source.min), ...corner(manifest.source.max)];
    this.setBox();
    const [vertexBytes, texelBytes] = [vertexBytesOf(root), texelBytesOf(root)];
    this.refinement = new Refinement(tree, index, this.store, (record, { level }) =>
      mostMemory(record, { level, vertexBytes, wires: this.look.wires, texelBytes }));
    this.refinement.showsInside = this.isCutOpen;
    this.account.fetched(index.record(ROOT)!.bytes);
    this.showOutline();
    this.changed();
  }

  private came({ key, node }: ResidentTile): void {
    this.epochs.set(key, this.account.epoch);
    this.recover(key);
    const record = this.directory?.index.record(node);
    if (record) this.account.fetched(record.bytes);
    this.wake();
  }

  private tell(file: string | number, problem: unknown): void {
    if (this.ending.signal.aborted || this.isReplaced) return;
    if (problem instanceof HierarchyReplaced) {
      this.leave();
      return;
    }
    ++this.failed;
    this.missing.add(file);
    const message = problem instanceof Error ? problem.message : String(problem);
    this.dispatchEvent({ type: 'problem', message, files: this.missing.size });
    this.changed();
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
    this.dispatchEvent({ type: 'replaced', isLasting });
    this.changed();
  }

  private recover(file: string | number): void {
    if (this.missing.delete(file) && this.missing.size === 0) this.dispatchEvent({ type: 'recovered' });
  }

  /// Asks at once for what failed.
  retry(): void {
    if (this.isReplaced) return;
    this.store.retry();
    this.opening.hurry();
    if (this.isRootAll && this.root !== null) {
      this.isRootAll = false;
      void this.openDirectory(this.opening, this.root, this.opening.remote.manifest());
    }
    this.showOutline();
    this.changed();
  }

  /// For what went with the device.
  private askAgain(): void {
    this.store.dropLost(isOnlyOnGpu);
    this.changed();
  }

  /// The picture is another one.
  private changed(): void {
    this.isDirty = true;
    this.wake();
  }

  /// It may be another one.
  private wake(): void {
    this.isAwake = true;
    if (!this.ending.signal.aborted) this.dispatchEvent({ type: 'change' });
  }

  // ---- each frame

  /// Call before each frame; `now` as given to callbacks of requestAnimationFrame. Returns whether the picture is
  /// another one than that of the last frame.
  update(camera: PerspectiveCamera, viewport: Viewport, now: number): boolean {
    if (!this.store.has(ROOT_KEY)) return false;
    camera.updateWorldMatrix(true, false);
    this.tiles.updateWorldMatrix(true, false);
    const seesElse = this.motion.see(camera, this.tiles, viewport, now);
    this.measure(now);
    const isDue = seesElse || this.isAwake || this.motion.isMoving !== this.wasMoving;
    this.wasMoving = this.motion.isMoving;
    if (!isDue) return false;
    const isDirty = this.isDirty;
    this.isDirty = this.isAwake = false;
    this.viewpoint = viewpointOf(camera, this.tiles, viewport);
    this.pixels = viewport.width * viewport.height;
    const isElse = this.refine(this.viewpoint, now);
    this.setAlarm(now);
    return seesElse || isDirty || isElse;
  }

  /// Something may be due although nothing happens.
  private setAlarm(now: number): void {
    if (this.motion.isMoving) this.alarm.in(REST_MS);
    else if (this.state?.isComplete === false) this.alarm.in(this.state.isPausing ? PAUSE_MS : RETRY_MS);
    else if (this.store.nextTry < Infinity) this.alarm.in(Math.max(RETRY_MS, this.store.nextTry - now));
    else this.alarm.stop();
  }

  private measure(now: number): void {
    const { isMoving } = this.motion;
    const interval = now - this.lastFrame;
    this.lastFrame = now;
    if (!isMoving) return;
    if (!this.wasMoving) {
      ++this.account.epoch;
      this.rate.restart();
    } else if (interval < LONGEST_FRAME_MS) {
      this.rate.frame(interval, this.shownVertices(), this.state?.limited ?? false);
    }
  }

  /// Returns whether other tiles are drawn, or otherwise, than before. The root is drawn before anything else is asked for.
  private refine(viewpoint: Viewpoint, now: number): boolean {
    const vertices = this.motion.isMoving ? this.rate.budget : Infinity;
    const refinement = this.isFirstFrame ? null : this.refinement;
    this.state = refinement?.refine(viewpoint, { ...this.settings, vertices, atRest: !this.motion.isMoving }, now) ?? null;
    this.drawn = this.state?.drawn ?? [];
    this.store.keepWithin(now);
    const keys = this.state === null ? [ROOT_KEY] : this.drawn.map(({ key }) => key);
    const isElse = this.tiles.show(keys.map((key) => this.store.get(key)!), this.look, this.directory?.manifest.source.values);
    this.tiles.paint(this.drawn, this.look, this.settings.threshold);
    for (const node of this.tiles.takeDamaged())
      this.tell(keyOf(node.level, node.index), new HierarchyProblem(tilePath(node), 'a ghost is no vertex of its tile'));
    if (this.isSettled()) this.settle();
    if (this.isFirstFrame) {
      this.rootDrawn();
      this.changed();
    }
    this.isFirstFrame = false;
    return isElse;
  }

  private isSettled(): boolean {
    return !this.motion.isMoving && (this.state?.isComplete ?? this.isRootAll);
  }

  private settle(): void {
    this.account.settled(this.inView().map(({ key, record }) => ({ bytes: record.bytes, epoch: this.epochs.get(key) ?? 0 })));
  }

  private inView(): ChosenNode[] {
    return this.drawn.filter(({ inView }) => inView);
  }

  private shownVertices(): number {
    return this.inView().reduce((sum, { record }) => sum + record.own, 0);
  }

  // ---- what it tells

  /// The tiles of the cut that are in view.
  get shown(): Node[] {
    return this.inView().map(({ node }) => node);
  }

  /// The triangles that are drawn, in view or not, in coordinates that `surfaceMatrix` brings into the world.
  get surface(): readonly DrawnTile[] {
    return this.tiles.drawn();
  }

  get surfaceMatrix(): Readonly<Matrix4> {
    return this.tiles.matrixWorld;
  }

  /// No open border: it has an inside.
  get closed(): boolean {
    return this.root?.closed ?? false;
  }

  /// Whether the inside is in view, as of a model that is cut open: backs are then refined as fronts are.
  get showsInside(): boolean {
    return this.isCutOpen;
  }

  set showsInside(shows: boolean) {
    this.isCutOpen = shows;
    if (this.refinement) this.refinement.showsInside = shows;
    this.changed();
  }

  /// Null until `manifest` is there.
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

  private mode(shown: readonly ChosenNode[]): Mode {
    if (this.viewpoint === null || this.directory === null) return 'CWV';
    return modeOf(shown, this.silhouette, this.directory.tree.lastLevel, this.viewpoint, this.pixels);
  }

  stats(): Stats {
    const shown = this.inView();
    const levels = shown.map(({ node }) => node.level);
    const isRootAlone = this.state === null && this.root !== null;
    return {
      mode: this.mode(shown),
      framesPerSecond: this.rate.framesPerSecond,
      moving: this.motion.isMoving,
      settled: this.isSettled(),
      tiles: isRootAlone ? 1 : shown.length,
      triangles: isRootAlone ? this.root!.interiorCount : shown.reduce((sum, { key }) => sum + this.tiles.trianglesOf(key), 0),
      vertices: isRootAlone ? this.root!.own : this.shownVertices(),
      finestLevel: Math.max(0, ...levels),
      coarsestLevel: levels.length > 0 ? Math.min(...levels) : 0,
      vertexBudget: this.rate.budget,
      worstError: isRootAlone ? Infinity : shown.reduce((worst, { pixels }) => Math.max(worst, pixels), 0),
      residentTiles: this.store.residentCount,
      residentBytes: this.store.usedBytes,
      peakBytes: this.store.peakBytes,
      memoryBudget: this.settings.memoryBudget,
      fetchedBytes: this.account.fetchedBytes,
      fetchedFiles: this.account.fetchedFiles,
      wholeViewBytes: this.account.wholeViewBytes,
      savedBytes: this.account.savedBytes,
      hits: this.account.hits,
      pending: this.store.pending,
      aborted: this.store.aborted,
      failed: this.failed,
      evicted: this.store.evicted,
      decodeMilliseconds: this.decoder.milliseconds,
    };
  }

  /// Frees everything, also on the GPU; the view is of no use afterwards.
  dispose(): void {
    this.ending.abort(new Error('the view was closed'));
    this.opening.close();
    this.alarm.stop();
    this.store.dispose();
    this.decoder.dispose();
    this.tiles.dispose();
    this.outline.clear();
    this.removeFromParent();
  }
}

