// SPDX-License-Identifier: MIT
// A view frame by frame: how the camera moves, which tiles that asks for, and what became of it in figures.
import type { ChosenNode } from '../cut/choose_cut.js';
import { FrameRate } from '../cut/frame_rate.js';
import { PAUSE_MS } from '../cut/rest_detail.js';
import type { Viewpoint } from '../cut/viewpoint.js';
import { HierarchyProblem } from '../hierarchy/problem.js';
import { keyOf, tilePath, type Node } from '../hierarchy/tree.js';
import { Alarm } from './alarm.js';
import type { Loading } from './loading.js';
import { modeOf } from './mode.js';
import { Motion, REST_MS, viewpointOf, type Viewport } from './motion.js';
import type { ViewCamera } from './projection.js';
import type { Mode, Stats } from './settings.js';
import type { Share } from './share.js';
import type { ViewContext } from './view_context.js';

const LONGEST_FRAME_MS = 5000; // a longer one was no frame: the page slept
const RETRY_MS = 1000;
const ROOT_KEY = keyOf(0, 0);

export class Frames {
  readonly rate: FrameRate;
  private readonly motion = new Motion();
  private readonly alarm: Alarm;
  private viewpoint: Viewpoint | null = null;
  private pixels = 1;
  private wasMoving = false;
  private lastFrame = 0;

  constructor(private readonly context: ViewContext, private readonly loading: Loading) {
    this.rate = new FrameRate(context.settings.framesPerSecond);
    this.alarm = new Alarm(() => { context.wake(); });
  }

  /// Returns whether the picture is another one than that of the last frame. `share`: null: all that the settings allow.
  update(camera: ViewCamera, viewport: Viewport, now: number, share: Share | null): boolean {
    const { context, loading, motion } = this;
    this.take(share);
    if (!loading.store.has(ROOT_KEY)) return false;
    camera.updateWorldMatrix(true, false);
    context.tiles.updateWorldMatrix(true, false);
    const seesElse = motion.see(camera, context.tiles, viewport, now);
    this.measure(now);
    const isDue = seesElse || context.wantsFrame || motion.isMoving !== this.wasMoving;
    this.wasMoving = motion.isMoving;
    if (!isDue) return false;
    const isDirty = context.takeFrame();
    if (context.tiles.upload(motion.isMoving)) context.wake();
    this.viewpoint = viewpointOf(camera, context.tiles, viewport);
    this.pixels = viewport.width * viewport.height;
    const isElse = this.refine(this.viewpoint, now);
    this.setAlarm(now);
    return seesElse || isDirty || isElse;
  }

  /// The cut may be another one with more or fewer bytes; vertices count in the next frame of a movement.
  private take(share: Share | null): void {
    const { context, loading: { store } } = this;
    const before = context.mostBytes;
    context.share = share;
    store.budget = context.mostBytes;
    if (context.mostBytes !== before) context.wake();
  }

  /// The tiles of the cut that are in view.
  get inView(): ChosenNode[] {
    return this.drawn.filter(({ inView }) => inView);
  }

  stop(): void {
    this.alarm.stop();
  }

  stats(): Stats {
    const { context: { account, settings, form, tiles }, loading: { store, cut, decoder, failed } } = this;
    const shown = this.inView;
    const levels = shown.map(({ node }) => node.level);
    const alone = cut.state === null ? form.root : null;
    return {
      mode: this.mode(shown),
      framesPerSecond: this.rate.framesPerSecond,
      moving: this.motion.isMoving,
      settled: this.isSettled,
      tiles: alone ? 1 : shown.length,
      triangles: alone ? alone.interiorCount : shown.reduce((sum, { key }) => sum + tiles.trianglesOf(key), 0),
      vertices: alone ? alone.own : this.shownVertices,
      finestLevel: Math.max(0, ...levels),
      coarsestLevel: levels.length > 0 ? Math.min(...levels) : 0,
      vertexBudget: this.mostVertices,
      limited: cut.state?.limited ?? { vertices: false, bytes: false },
      wantedBytes: cut.state?.bytes ?? store.usedBytes,
      worstError: alone ? Infinity : shown.reduce((worst, { pixels }) => Math.max(worst, pixels), 0),
      residentTiles: store.residentCount,
      residentBytes: store.usedBytes,
      peakBytes: store.peakBytes,
      memoryBudget: settings.memoryBudget,
      fetchedBytes: account.fetchedBytes,
      fetchedFiles: account.fetchedFiles,
      wholeViewBytes: account.wholeViewBytes,
      savedBytes: account.savedBytes,
      hits: account.hits,
      pending: store.pending,
      aborted: store.aborted,
      failed,
      evicted: store.evicted,
      decodeMilliseconds: decoder.milliseconds,
    };
  }

  private get drawn(): readonly ChosenNode[] {
    return this.loading.cut.state?.drawn ?? [];
  }

  private get shownVertices(): number {
    return this.inView.reduce((sum, { record }) => sum + record.own, 0);
  }

  /// While the camera moves.
  private get mostVertices(): number {
    return this.context.share?.vertices ?? this.rate.budget;
  }

  private get isSettled(): boolean {
    const { state, isRootAll } = this.loading.cut;
    return !this.motion.isMoving && (state?.isComplete ?? isRootAll);
  }

  private mode(shown: readonly ChosenNode[]): Mode {
    const { directory } = this.loading;
    if (this.viewpoint === null || directory === null) return 'CWV';
    return modeOf(shown, this.context.form.silhouette, directory.tree.lastLevel, this.viewpoint, this.pixels);
  }

  private measure(now: number): void {
    const { isMoving } = this.motion;
    const interval = now - this.lastFrame;
    this.lastFrame = now;
    if (!isMoving) return;
    if (!this.wasMoving) {
      ++this.context.account.epoch;
      this.rate.restart();
    } else if (interval < LONGEST_FRAME_MS) {
      this.rate.frame(interval, this.shownVertices, this.loading.cut.state?.limited.vertices ?? false);
    }
  }

  /// Returns whether other tiles are drawn, or otherwise, than before. The root is drawn before anything else is asked for.
  private refine(viewpoint: Viewpoint, now: number): boolean {
    const { context: { settings, showsInside, hidesBacks, mostLevel }, loading: { cut, store }, motion: { isMoving } } = this;
    const vertices = isMoving ? this.mostVertices : Infinity;
    const refinement = cut.isFirstFrame ? null : cut.refinement;
    if (refinement !== null) Object.assign(refinement, { showsInside, hidesBacks });
    cut.state = refinement?.refine(viewpoint, { ...settings, vertices, mostLevel: mostLevel ?? Infinity, atRest: !isMoving }, now) ?? null;
    store.keepWithin(now);
    const isElse = this.show();
    if (this.isSettled) this.settle();
    if (cut.isFirstFrame) {
      cut.rootDrawn();
      this.context.changed();
    }
    cut.isFirstFrame = false;
    return isElse;
  }

  /// Draws the cut that was chosen.
  private show(): boolean {
    const { context: { tiles, look, settings }, loading } = this;
    const keys = loading.cut.state === null ? [ROOT_KEY] : this.drawn.map(({ key }) => key);
    const isElse = tiles.show(keys.map((key) => loading.store.get(key)!), look, loading.directory?.manifest.source.values);
    tiles.paint(this.drawn, look, settings.threshold);
    for (const node of tiles.takeDamaged()) this.tellDamaged(node);
    return isElse;
  }

  private tellDamaged(node: Node): void {
    this.loading.tell(keyOf(node.level, node.index), new HierarchyProblem(tilePath(node), 'a ghost is no vertex of its tile'));
  }

  private settle(): void {
    this.context.account.settled(this.inView.map(({ key, record }) => ({ bytes: record.bytes, epoch: this.loading.epochOf(key) })));
  }

  /// Something may be due although nothing happens.
  private setAlarm(now: number): void {
    const { cut: { state }, store } = this.loading;
    if (this.motion.isMoving) this.alarm.in(REST_MS);
    else if (state?.isComplete === false) this.alarm.in(state.isPausing ? PAUSE_MS : RETRY_MS);
    else if (store.nextTry < Infinity) this.alarm.in(Math.max(RETRY_MS, store.nextTry - now));
    else this.alarm.stop();
  }
}
