// SPDX-License-Identifier: MIT
// A hierarchy as an object of a three scene: loads what the view needs, draws one cut without cracks.
import { Group, type Box3, type Material, type Matrix4, type Scene, type Side, type Vector3, type WebGLRenderer } from 'three';
import type { Vector } from '../cut/viewpoint.js';
import type { Manifest } from '../hierarchy/manifest.js';
import type { ObjectTable } from '../hierarchy/object_table.js';
import type { Tile } from '../hierarchy/tile.js';
import type { Node } from '../hierarchy/tree.js';
import { Attributes } from '../plugins/attributes.js';
import { Plugins, type PluginOf, type StageOf } from '../plugins/plugin.js';
import { Relief } from '../plugins/relief.js';
import { Frames } from './frames.js';
import { Loading } from './loading.js';
import type { Viewport } from './motion.js';
import type { Omits } from './omission.js';
import type { ViewCamera } from './projection.js';
import { changedSettings, type Look, type Settings, type Stats } from './settings.js';
import type { Share } from './share.js';
import type { Standing } from './standing.js';
import type { DrawnTile, TileSource } from './surface.js';
import type { Terrain } from './terrain.js';
import type { View } from '../view/view_table.js';
import { TileScene } from './tile_scene.js';
import { ViewContext } from './view_context.js';
import type { ViewEvents, ViewOptions } from './view_options.js';

/// A plug-in of a view, and a stage that shows a view with its plug-ins.
export type Plugin = PluginOf<HierarchyView>;
export type Stage = StageOf<HierarchyView>;

/// Add it to a scene, call `update` before each frame, and draw when that returns true or a `change` event came. Until something is known
/// of the model, members say so: none throws for being asked early.
export class HierarchyView extends Group<ViewEvents> {
  /// Resolves when the root can be drawn: after one request. Rejects with HierarchyProblem, which names the file; nobody must wait for it.
  readonly opened: Promise<void>;
  /// A stage enters here, and asks the plug-ins.
  readonly plugins: Plugins<HierarchyView>;
  private readonly tiles = new TileScene(() => { this.loading.askAgain(); }, () => { this.context.changed(); });
  private readonly context: ViewContext;
  private readonly loading: Loading;
  private readonly frames: Frames;

  /// Begins to fetch at once. `url`: of the hierarchy's directory, or of its archive. Throws RangeError for settings or a standing out of range.
  constructor(url: string, options: ViewOptions = {}) {
    super();
    this.context = new ViewContext(options, this.tiles, this);
    this.loading = new Loading(url, this.context);
    this.frames = new Frames(this.context, this.loading);
    this.plugins = new Plugins<HierarchyView>(this, (shadings) => {
      if (shadings !== null) this.tiles.shadings = shadings;
      this.context.changed();
    });
    for (const plugin of [new Attributes(), new Relief()]) this.plugins.register(plugin);
    this.add(this.tiles);
    this.opened = this.loading.open();
    this.opened.catch(() => undefined); // whoever waits is told; nobody must
    globalThis.addEventListener?.('online', () => { this.retry(); }, { signal: this.context.ending.signal });
  }

  // ---- what is chosen

  get settings(): Readonly<Settings> {
    return this.context.settings;
  }

  /// Holds from the next frame on. Throws RangeError for a number out of its range, and then changes nothing.
  setSettings(change: Partial<Settings>): void {
    const { context, loading, frames } = this;
    context.settings = changedSettings(change, context.settings);
    frames.rate.target = context.settings.framesPerSecond;
    loading.store.budget = context.mostBytes;
    context.changed();
  }

  get look(): Readonly<Look> {
    return this.context.look;
  }

  /// Holds from the next frame on. A look that asks for what the model lacks shows what it has.
  setLook(change: Partial<Look>): void {
    this.context.choose(change);
    this.loading.store.recount();
    this.loading.showOutline();
  }

  get standing(): Readonly<Standing> {
    return this.context.standing;
  }

  /// `box` is another one afterwards. Throws RangeError for what is out of range, and then changes nothing.
  setStanding(change: Partial<Standing>): void {
    const { context } = this;
    context.stand(change);
    context.changed();
  }

  /// True while the inside is in view, as of a model that is cut open: backs are then refined as fronts are.
  get showsInside(): boolean {
    return this.context.showsInside;
  }

  set showsInside(shows: boolean) {
    this.context.showsInside = shows;
    this.context.changed();
  }

  /// Tiles of this level at the most are shown: the root's is 0. Null: down to the original.
  get mostLevel(): number | null {
    return this.context.mostLevel;
  }

  set mostLevel(level: number | null) {
    this.context.mostLevel = level;
    this.context.changed();
  }

  /// True while faces that look away from the camera are not drawn, by the order of their corners: from outside one looks into rooms. Then rays
  /// that pick meet none of them, and tiles that show nothing else stay coarse.
  get hidesBacks(): boolean {
    return this.context.hidesBacks;
  }

  set hidesBacks(hides: boolean) {
    this.context.hidesBacks = this.tiles.hidesBacks = hides;
    this.context.changed();
  }

  // ---- what the model is

  /// All of the model in one tile, coarse; null: it has not come yet.
  get root(): Tile | null {
    return this.context.form.root;
  }

  /// The model's box, upright, in the coordinates of this group; empty until the root is there.
  get box(): Box3 {
    return this.context.form.box;
  }

  /// Null until it has come.
  get manifest(): Manifest | null {
    return this.loading.manifest;
  }

  /// The mesh as a terrain, as it stands; null: it is none, or not known yet.
  get terrain(): Terrain | null {
    return this.context.form.terrain;
  }

  /// The direction that is up as the mesh stands, in its own coordinates, of length 1.
  get upwards(): Vector {
    return this.context.form.upwards(this.standing);
  }

  /// The model is looked at first from this side: to the viewer, of length 1, in the coordinates of this group. Null: not known yet, an older
  /// hierarchy does not say it, or the mesh stands on another axis.
  get firstDirection(): Vector | null {
    return this.context.form.firstDirection(this.standing);
  }

  /// Yields points of the root's outline from all sides, as they stand in this group, in one and the same vector. None: not known yet.
  shape(): Iterable<Vector3> {
    return this.context.form.shape();
  }

  /// True where the mesh has colours or pictures of its own; those that are white everywhere say nothing. Null: not known yet.
  get hasColours(): boolean | null {
    return this.context.form.hasColours;
  }

  /// True where vertices have something besides normals, colours and texture coordinates; null: not known yet.
  get hasAttributes(): boolean | null {
    return this.context.form.hasAttributes;
  }

  /// True where the mesh has triangles, and not only points; null: not known yet.
  get hasTriangles(): boolean | null {
    return this.context.form.hasTriangles;
  }

  /// True where the mesh has no open border, and so an inside; false until the root is there.
  get closed(): boolean {
    return this.context.form.root?.closed ?? false;
  }

  // ---- what is shown

  /// Chooses the cut, and asks for what it lacks. Call it before each frame; `now` as given to callbacks of requestAnimationFrame, `viewport` in
  /// pixels of the picture, whose rays may be parallel. Returns whether the picture is another one than that of the last frame; false until the root is
  /// there. `share`: instead of what the settings allow, for views that share one budget (pair/pair.ts).
  update(camera: ViewCamera, viewport: Viewport, now: number, share: Share | null = null): boolean {
    return this.frames.update(camera, viewport, now, share);
  }

  /// Draws a frame as plug-ins want it: call it instead of `renderer.render(scene, camera)` where there are some that draw.
  draw(renderer: WebGLRenderer, scene: Scene, camera: ViewCamera): void {
    const frame = { renderer, scene, camera };
    this.plugins.paint(frame);
    this.plugins.drawn(frame);
  }

  /// The tiles of the cut that are in view.
  get shown(): Node[] {
    return this.frames.inView.map(({ node }) => node);
  }

  /// The triangles that are drawn, in view or not, in coordinates that `surfaceMatrix` brings into the world.
  get surface(): readonly DrawnTile[] {
    return this.tiles.drawn();
  }

  /// Which sides of tiles are drawn: so are those of a material with which they are drawn in a pass of your own.
  get side(): Side {
    return this.tiles.side;
  }

  /// Tells of a vertex of a tile whether plug-ins leave it out; null: they leave out nothing.
  get omits(): Omits | null {
    return this.tiles.omits;
  }

  /// Another text whenever plug-ins leave out something else: what was measured without it is measured anew.
  get omissionKey(): string {
    return this.tiles.omissionKey;
  }

  /// Makes a material, with which tiles are to be drawn in a pass of your own, leave out what plug-ins leave out now: call it before each pass,
  /// which draws tiles alone. Returns whether anything may be left out.
  leaveOut(material: Material): boolean {
    this.tiles.leaveOut(material);
    return this.omits !== null;
  }

  /// Brings the tiles' coordinates into the world; of the last `update`.
  get surfaceMatrix(): Readonly<Matrix4> {
    return this.tiles.matrixWorld;
  }

  /// Gives tools the tiles that are not drawn. Null until `manifest` is there.
  get source(): TileSource | null {
    return this.loading.source;
  }

  /// Figures as of now; they cost little, and may be asked for in each frame.
  stats(): Stats {
    return this.frames.stats();
  }

  /// The names and properties of the model's objects, read as they are asked for. Null: it has none, or it is not known yet.
  get objects(): ObjectTable | null {
    return this.loading.objects;
  }

  // ---- plug-ins, and the host

  /// Throws Error where there is one of that name, and what `init` or `enter` throws: then it is not there. May be called at any time.
  registerPlugin(plugin: Plugin): this {
    this.plugins.register(plugin);
    return this;
  }

  /// Takes a plug-in away, and calls its `dispose`; nothing happens where it is not there.
  unregisterPlugin(plugin: Plugin): void {
    this.plugins.unregister(plugin);
  }

  /// Begins anew, with what the host has now: as after `replaced`. What is seen stays until the root has come, and how it is looked at stays.
  /// Resolves and rejects as `opened` does.
  async reload(): Promise<void> {
    return this.loading.reload();
  }

  /// The host keeps another first view of the model: `build` is its name from now on. What is shown stays as it is.
  takeFirstView(build: string, first: View): void {
    this.loading.takeFirstView(build, first);
  }

  /// Asks at once for what failed; the view does so by itself, but later.
  retry(): void {
    this.loading.retry();
  }

  /// Frees everything, also on the GPU, and disposes of plug-ins; the view is of no use afterwards.
  dispose(): void {
    this.context.ending.abort(new Error('the view was closed'));
    this.plugins.dispose();
    this.frames.stop();
    this.loading.dispose();
    this.tiles.dispose();
    this.removeFromParent();
  }
}
