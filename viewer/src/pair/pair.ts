// SPDX-License-Identifier: MIT
// Two views in one picture, for the eye to compare: one renderer, one camera, one budget.
//
//      swipe            side by side       blink              overlay
//      +-----|----+     +-----+-----+      +----------+       +----------+
//      | a a | b b|     |  a  |  b  |      |  a or b  |       |  a over b, each in one colour
//      +-----|----+     +-----+-----+      +----------+       +----------+
//
// Each part is drawn as the view alone would draw it, with its own depth range and light: its pixels are the same ones.
import { Box3, Vector2, type Matrix4, type Scene, type WebGLRenderer } from 'three';
import type { ViewCamera } from '../scene/projection.js';
import type { Manifest } from '../hierarchy/manifest.js';
import type { HierarchyView } from '../scene/hierarchy_view.js';
import type { Viewport } from '../scene/motion.js';
import type { Stats } from '../scene/settings.js';
import type { Frame } from '../plugins/plugin.js';
import { PairBudget, type Both } from './budget.js';
import { OverlayPainter } from './overlay_painter.js';
import { alignedMatrix, groupMatrix, layingOf, worldBox, type Laying } from './placing.js';
import { SameCuts } from './same_cuts.js';
import { Tint } from './tint.js';
import type { Way } from './ways.js';

/// The first view, or the second.
export type Side = 0 | 1;

/// Colours of the two models in an overlay.
export const TINTS: Both<number> = [0x3b7dd8, 0xe8892b];

export interface PairOptions {
  /// Called before a side is looked at or drawn, and with null before both are drawn into one picture: time to give the camera its depth
  /// range, and the scene its light.
  readonly prepare?: (side: Side | null) => void;
}

export interface PairStats {
  readonly views: Both<Stats>;
  readonly settled: boolean;
  /// Both views take so much together; the most that they ever took; and the most allowed.
  readonly residentBytes: number;
  readonly peakBytes: number;
  readonly memoryBudget: number;
  readonly vertices: number;
  readonly vertexBudget: number;
  readonly framesPerSecond: number;
}

/// A place of the picture, from -1 to 1, within the part that shows a view.
export interface SeenPlace {
  readonly sides: readonly Side[];
  readonly right: number;
  readonly up: number;
}

/// Pixels of the picture, the left edge first.
interface Column {
  readonly side: Side;
  readonly begin: number;
  readonly end: number;
}

/// Both views must be in the scene, the second one with no place of its own. It is not seen before the manifests of both are there.
export class Pair {
  /// The part of the picture's width that shows the first view, in a swipe.
  divider = 0.5;
  /// Shown by a blink.
  shown: Side = 0;
  laying: Laying | null = null;
  private wished: Way = 'swipe';
  private isAligned = false;
  private placedBy: readonly unknown[] = [];
  private readonly budget: PairBudget;
  private readonly tints: Both<Tint> = [new Tint(TINTS[0]), new Tint(TINTS[1])];
  private readonly cuts: SameCuts;
  private overlay: OverlayPainter | null = null;
  private readonly prepare: (side: Side | null) => void;

  constructor(readonly first: HierarchyView, readonly second: HierarchyView, options: PairOptions = {}) {
    this.prepare = options.prepare ?? (() => undefined);
    this.budget = new PairBudget(first.settings.framesPerSecond);
    second.matrixAutoUpdate = false;
    second.visible = false;
    this.cuts = new SameCuts(first);
    second.registerPlugin(this.cuts);
  }

  get views(): Both<HierarchyView> {
    return [this.first, this.second];
  }

  get way(): Way {
    return this.wished;
  }

  set way(way: Way) {
    const [before, now] = [this.wished, way].map((each) => each === 'overlay');
    this.wished = way;
    if (before === now) return;
    this.views.forEach((view, i) => {
      if (now) view.registerPlugin(this.tints[i]);
      else view.unregisterPlugin(this.tints[i]);
    });
    if (!now) this.overlay?.dispose();
    this.overlay = now ? new OverlayPainter() : null;
  }

  /// Pictures beside each other: the camera is of one of them, and so is the viewport given to `update`.
  get columns(): 1 | 2 {
    return this.wished === 'side' ? 2 : 1;
  }

  /// Both are there, and the second one has its place.
  get isReady(): boolean {
    return this.laying !== null;
  }

  /// Both boxes in the world; of the first alone while the second has no place, or lies elsewhere.
  get box(): Box3 {
    const box = worldBox(this.first);
    return this.isReady && this.overlaps ? box.union(worldBox(this.second)) : box;
  }

  /// Where both are, there is something to compare. True while that is not known.
  get overlaps(): boolean {
    return !this.isReady || worldBox(this.first).intersectsBox(worldBox(this.second));
  }

  /// The middles of both boxes are laid on each other, to be looked at: nothing is measured between them then.
  get aligned(): boolean {
    return this.isAligned;
  }

  set aligned(is: boolean) {
    this.isAligned = is;
    this.placedBy = [];
    this.place();
  }

  /// Instead of both views' own: call it before each frame. `viewport`: of one column.
  update(camera: ViewCamera, viewport: Viewport, now: number): boolean {
    const { views, budget } = this;
    const hasMoved = this.place();
    budget.rate.target = this.first.settings.framesPerSecond;
    const shares = budget.take(this.allStats(), this.allBytes, now);
    const news = views.map((view, i) => {
      this.prepare(i as Side);
      return view.update(camera, viewport, now, shares[i]);
    });
    for (const each of ['showsInside', 'hidesBacks'] as const) if (this.second[each] !== this.first[each]) this.second[each] = this.first[each];
    return news.some((each) => each) || hasMoved || budget.isUneasy(this.allStats(), this.allBytes);
  }

  draw(renderer: WebGLRenderer, scene: Scene, camera: ViewCamera): void {
    const frame = { renderer, scene, camera };
    this.paint(frame);
    for (const view of this.views) view.plugins.drawn(frame);
  }

  /// Draws the picture, or the part of a larger one that the camera says.
  paint(frame: Frame): void {
    if (!this.isReady) this.paintSide(0, frame);
    else if (this.wished === 'blink') this.paintSide(this.shown, frame);
    else if (this.wished === 'overlay') this.paintBoth(frame);
    else this.paintColumns(frame);
  }

  /// Which views are seen at a place of the picture, and where in their part of it.
  seenAt(right: number, up: number): SeenPlace {
    if (!this.isReady) return { sides: [0], right: this.wished === 'side' ? right * 2 + 1 : right, up };
    if (this.wished === 'overlay') return { sides: [0, 1], right, up };
    if (this.wished === 'blink') return { sides: [this.shown], right, up };
    if (this.wished === 'swipe') return { sides: [(right + 1) / 2 < this.divider ? 0 : 1], right, up };
    if (right === 0) return { sides: [0], right: 0, up }; // keys take the middle
    return right < 0 ? { sides: [0], right: right * 2 + 1, up } : { sides: [1], right: right * 2 - 1, up };
  }

  stats(): PairStats {
    const views = this.allStats();
    const sum = (of: (stats: Stats) => number): number => of(views[0]) + of(views[1]);
    const residentBytes = sum((each) => each.residentBytes);
    const { rate, peakBytes } = this.budget;
    return {
      views,
      settled: views.every(({ settled }) => settled) && !this.budget.isUneasy(views, this.allBytes),
      residentBytes,
      peakBytes: Math.max(peakBytes, residentBytes),
      memoryBudget: this.allBytes,
      vertices: sum(({ vertices }) => vertices),
      vertexBudget: rate.budget,
      framesPerSecond: rate.framesPerSecond,
    };
  }

  /// From the second view's group to the world.
  get secondMatrix(): Readonly<Matrix4> {
    return this.second.matrix;
  }

  /// The views stay, as they are without a pair; they are yours to dispose of.
  dispose(): void {
    this.way = 'swipe';
    this.second.unregisterPlugin(this.cuts);
    this.first.visible = true;
  }

  private get allBytes(): number {
    return this.first.settings.memoryBudget;
  }

  private allStats(): Both<Stats> {
    return [this.first.stats(), this.second.stats()];
  }

  /// As manifests and standing say now. True: the second view has another place than before.
  private place(): boolean {
    const { first, second, isAligned } = this;
    const [one, other] = [first.manifest, second.manifest];
    if (one === null || other === null) return false;
    const { up, stretch } = first.standing;
    const by = [one, other, up, stretch, isAligned, first.matrixWorld.elements.join(), isAligned ? second.box.max.toArray().join() : ''];
    if (by.every((each, i) => each === this.placedBy[i])) return false;
    this.placedBy = by;
    this.settle(one, other);
    return true;
  }

  private settle(one: Manifest, other: Manifest): void {
    const { first, second } = this;
    if (JSON.stringify(second.standing) !== JSON.stringify(first.standing)) second.setStanding(first.standing);
    this.laying = layingOf(one, other, first.standing);
    second.matrix.copy(groupMatrix(one, other, this.laying, first.standing, first.matrixWorld));
    if (this.isAligned) second.matrix.premultiply(alignedMatrix(worldBox(first), second.box.clone().applyMatrix4(second.matrix)));
    second.matrixWorldNeedsUpdate = true;
    second.updateMatrixWorld(true);
  }

  private paintSide(side: Side, frame: Frame): void {
    this.prepare(side);
    this.alone(side, () => { this.views[side].plugins.paint(frame); });
  }

  private paintBoth(frame: Frame): void {
    this.prepare(null);
    this.overlay!.paint(frame.renderer, frame.camera, (side) => { this.alone(side, () => { this.views[side].plugins.paint(frame); }); });
  }

  private alone(side: Side, draw: () => void): void {
    const { views } = this;
    const before = views.map(({ visible }) => visible);
    views.forEach((view, i) => { view.visible = i === side; });
    draw();
    views.forEach((view, i) => { view.visible = before[i]; });
  }

  private paintColumns(frame: Frame): void {
    const { renderer } = frame;
    const ratio = renderer.getPixelRatio();
    const size = renderer.getDrawingBufferSize(new Vector2());
    for (const column of this.columnsOf(frame, size)) if (column.end > column.begin) this.paintColumn(column, frame, size, ratio);
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, size.x / ratio, size.y / ratio);
  }

  /// Columns of the whole picture, however small a part of it is drawn.
  private columnsOf({ camera: { view } }: Frame, size: Vector2): readonly Column[] {
    const whole = view?.enabled === true ? view.fullWidth : size.x;
    const middle = Math.round(whole * (this.wished === 'side' ? 0.5 : this.divider));
    return [{ side: 0, begin: 0, end: middle }, { side: 1, begin: middle, end: whole }];
  }

  /// Scissors let nothing but the column through; side by side it has a camera's picture of its own.
  private paintColumn({ side, begin, end }: Column, frame: Frame, size: Vector2, ratio: number): void {
    const { renderer, camera } = frame;
    const asked = camera.view?.enabled === true ? { ...camera.view } : null;
    const shift = asked === null ? 0 : asked.offsetX;
    const [left, right] = [Math.max(begin - shift, 0), Math.min(end - shift, size.x)];
    if (right <= left) return;
    const put = (from: number, width: number): readonly [number, number, number, number] => [from / ratio, 0, width / ratio, size.y / ratio];
    renderer.setScissorTest(true);
    renderer.setScissor(...put(left, right - left));
    renderer.setViewport(...(this.wished === 'side' ? put(left, right - left) : put(0, size.x)));
    if (this.wished === 'side' && asked !== null) camera.setViewOffset(end - begin, asked.fullHeight, left + shift - begin, asked.offsetY, right - left, asked.height);
    this.paintSide(side, frame);
    if (asked !== null) camera.setViewOffset(asked.fullWidth, asked.fullHeight, asked.offsetX, asked.offsetY, asked.width, asked.height);
  }
}
