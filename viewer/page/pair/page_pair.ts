// SPDX-License-Identifier: MIT
// A second model in a model's view: loaded, placed, lit and coloured as the first one is, and drawn in one picture with it.
import { Raycaster, Vector2, type Box3, type Vector3 } from 'three';
import TileWorker from '../../src/hierarchy/tile_worker.js?worker';
import { attributeIndex, HierarchyView, wholeRange, type Look, type Stage } from '../../src/index.js';
import { Pair, PairPoints, WAYS, type PairStats, type Side } from '../../src/pair/index.js';
import { worldBox } from '../../src/pair/placing.js';
import type { Occlusion } from '../../src/plugins/occlusion.js';
import { drawnHit } from '../../src/scene/drawn_hits.js';
import type { Viewport } from '../../src/scene/motion.js';
import type { Appearance } from '../appearance.js';
import { formatCount } from '../numbers.js';
import type { Model } from '../listing.js';
import type { PageContext } from '../view/page_context.js';
import type { PageStage } from '../view/page_stage.js';
import type { Partner } from '../view/partner.js';
import { shownOf } from '../view/presentation.js';
import type { ViewChoices } from '../view/view_choices.js';
import { words } from '../words/words.js';
import { Blinking } from './blinking.js';
import { Divider } from './divider.js';
import { PairBar } from './pair_bar.js';
import { PairFigures } from './pair_figures.js';
import type { PairLook } from './pair_link.js';
import './pair.css';

const REQUESTS = 6;
/// Both models are of one colour each, so that what is between them is seen.
const OVERLAID: Partial<Look> = { colours: 'plain', texture: false };

export class PagePair implements Partner {
  readonly view: HierarchyView;
  readonly pair: Pair;
  readonly points: PairPoints;
  private readonly context: PageContext;
  private readonly divider: Divider;
  private readonly bar: PairBar;
  private readonly figures = new PairFigures();
  private readonly blinking: Blinking;
  private readonly raycaster = new Raycaster();
  private readonly marks = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  private look: PairLook | null = null;
  private occlusion: Occlusion | null = null;
  private missing: (() => void) | undefined;
  private isRefused = false;

  /// `choose`: the visitor wants to look otherwise; `end`: at the first model alone.
  constructor(stage: PageStage, private readonly choices: ViewChoices, readonly model: Model, private readonly choose: (change: Partial<PairLook>) => void, end: () => void) {
    const { context } = stage;
    this.context = context;
    this.view = new HierarchyView(model.url, { createWorker: () => new TileWorker(), settings: context.view.settings, requests: REQUESTS });
    context.canvas.scene.add(this.view);
    const prepare = (side: Side | null): void => { this.prepare(side); };
    this.pair = new Pair(context.view, this.view, { prepare });
    this.points = new PairPoints(this.pair, context.canvas.camera, prepare);
    this.view.plugins.enter(Object.create(stage, { view: { value: this.view } }) as Stage); // the same stage, with this view on it
    this.blinking = new Blinking(() => { this.turn(); });
    this.divider = new Divider(context.surface, (divider) => { choose({ divider }); });
    this.bar = new PairBar([context.model.name, model.name], {
      way: (way) => { choose({ way }); },
      show: (side) => { this.turn(side); },
      blinks: (on) => { this.blinking.set(on); this.showBar(); },
      align: (on) => { this.align(on); },
      end,
    }, this.blinking.isAllowed);
    this.marks.setAttribute('class', 'tool-overlay-beside');
    this.marks.setAttribute('aria-hidden', 'true');
    context.surface.after(this.divider.root, this.marks);
    context.root.append(this.bar.root);
    context.root.classList.add('with-pair');
    this.figures.enter(context.root, [context.model.name, model.name]);
    context.canvas.partner = this;
    this.listen();
  }

  get columns(): 1 | 2 {
    return this.pair.columns;
  }

  get box(): Box3 {
    return this.pair.box;
  }

  /// One that cannot be had is not waited for.
  get isSettled(): boolean {
    return this.isRefused ? this.context.view.stats().settled : this.pair.stats().settled;
  }

  *shape(): Iterable<Vector3> {
    yield* this.context.view.shape();
    if (this.pair.isReady && this.pair.overlaps) for (const point of this.view.shape()) yield point.applyMatrix4(this.view.matrix);
  }

  stats(): PairStats {
    return this.pair.stats();
  }

  update(viewport: Viewport, now: number): boolean {
    const wasReady = this.pair.isReady;
    const news = this.pair.update(this.context.canvas.camera, viewport, now);
    if (!wasReady && this.pair.isReady) this.arrived();
    return news;
  }

  paint(): void {
    this.pair.paint(this.context.canvas);
  }

  /// Side by side, marks stand in both columns.
  drawn(): void {
    const marks = this.columns === 1 ? null : this.context.root.querySelector('.tool-overlay');
    if (marks === null && this.marks.childElementCount === 0) return;
    this.marks.replaceChildren(...(marks?.cloneNode(true).childNodes ?? []));
  }

  inColumn(right: number, up: number): readonly [number, number] {
    const seen = this.pair.seenAt(right, up);
    return [seen.right, seen.up];
  }

  /// What is grabbed by hands: of the model that is seen there.
  pick(right: number, up: number): Vector3 | null {
    const sides: readonly Side[] = this.columns === 2 ? [0, 1] : this.pair.seenAt(right, up).sides;
    this.raycaster.setFromCamera(new Vector2(right, up), this.context.canvas.camera);
    const hits = sides.flatMap((side) => drawnHit(this.raycaster, this.pair.views[side]) ?? []);
    return hits.sort((a, b) => a.distance - b.distance).at(0)?.point ?? null;
  }

  show(look: PairLook): void {
    const wasOverlaid = this.pair.way === 'overlay';
    const isElsewhere = this.look?.way !== look.way;
    this.look = look;
    this.pair.way = look.way;
    this.pair.divider = look.divider;
    this.divider.show(look.divider);
    this.divider.root.hidden = look.way !== 'swipe' || !this.pair.isReady;
    this.context.root.dataset.way = look.way;
    this.blinking.begin(look.way === 'blink');
    if (wasOverlaid !== (look.way === 'overlay')) this.overlay(look.way === 'overlay');
    if (isElsewhere) this.context.canvas.fitAgain();
    this.showBar();
    this.context.redraw();
  }

  /// The next way of looking.
  next(): void {
    this.choose({ way: WAYS[(WAYS.indexOf(this.pair.way) + 1) % WAYS.length] });
  }

  /// Shows the other model, in a blink.
  turn(side = (1 - this.pair.shown) as Side): void {
    this.pair.shown = side;
    if (this.pair.way !== 'blink') this.choose({ way: 'blink' });
    this.showBar();
    this.context.redraw();
  }

  moveDivider(steps: number): void {
    if (this.pair.way === 'swipe') this.divider.step(steps);
  }

  close(): void {
    this.blinking.begin(false);
    this.context.canvas.partner = null;
    this.pair.dispose();
    this.view.dispose();
  }

  private listen(): void {
    const { context, view, model } = this;
    view.addEventListener('change', () => { context.dispatchEvent({ type: 'wake' }); });
    view.addEventListener('problem', ({ message, files }) => {
      const text = words.problems.missing(model.name, files, formatCount(files));
      if (!this.pair.isReady) this.bar.fail(words.pair.notThere(model.name));
      this.missing = context.page.problems.tell(text, { more: message, subject: 'missing beside', retry: () => { view.retry(); } });
    });
    view.addEventListener('recovered', () => { this.missing?.(); });
    view.addEventListener('replaced', () => { this.tellReplaced(); });
    context.addEventListener('chosen', () => { this.follow(); });
    context.addEventListener('report', () => { this.figures.show(this.pair.stats()); });
    void this.await(view.opened);
  }

  private async await(opened: Promise<void>): Promise<void> {
    const { context, model } = this;
    try {
      await opened;
      this.isRefused = false;
    } catch (error) {
      if (context.signal.aborted) return;
      this.isRefused = true;
      const retry = (): void => {
        done();
        void this.await(this.view.reload());
      };
      this.bar.fail(words.pair.notThere(model.name));
      const done = context.page.problems.tell(words.pair.notOpened(model.name, context.model.name), { more: error instanceof Error ? error.message : String(error), subject: 'beside', retry });
    }
    this.follow();
    context.redraw();
  }

  private tellReplaced(): void {
    const { context, model: { name } } = this;
    const reload = (): void => {
      done();
      void this.await(this.view.reload());
    };
    const done = context.page.problems.tell(words.problems.replaced(name), { more: words.problems.replacedMore, subject: 'replaced beside', retry: reload, retryText: words.parts.reload });
  }

  /// The second model has its place.
  private arrived(): void {
    if (this.look !== null) this.show(this.look);
    this.follow();
    this.showBar();
    this.context.redraw();
  }

  /// As it was chosen for the first model.
  private follow(): void {
    const { view, context } = this;
    if (JSON.stringify(view.settings) !== JSON.stringify(context.view.settings)) view.setSettings(context.view.settings);
    if (view.mostLevel !== context.view.mostLevel) view.mostLevel = context.view.mostLevel;
    const { look } = shownOf(this.chosen(1), view);
    const shown = this.pair.way === 'overlay' ? { ...look, ...OVERLAID } : look;
    if (JSON.stringify(shown) !== JSON.stringify(view.look)) view.setLook(shown);
    this.occlude().catch(() => undefined); // the first model tells of it
    this.showBar();
  }

  private chosen(side: Side): Appearance {
    const { chosen } = this.choices;
    return side === 0 || chosen.look.colours !== 'attribute' ? chosen : { ...chosen, look: { ...chosen.look, ...this.sameAttribute(chosen.look) } };
  }

  /// One attribute, with one range, colours both; a model that lacks it is plain.
  private sameAttribute(look: Look): Partial<Look> {
    const values = this.context.view.manifest?.source.values ?? [];
    const attribute = values[attributeIndex(values, look.attribute)];
    if (attribute === undefined) return {};
    if (this.lacks(attribute.name)) return { colours: 'plain' };
    return { attribute: attribute.name, range: look.range ?? wholeRange(attribute, look.ramp) };
  }

  private lacks(name: string): boolean {
    const { manifest } = this.view;
    return manifest !== null && !manifest.source.values.some((each) => each.name === name);
  }

  private lackedAttribute(): string | null {
    const { look } = this.context.view;
    const values = this.context.view.manifest?.source.values ?? [];
    const attribute = values[attributeIndex(values, look.attribute)];
    return look.colours === 'attribute' && attribute !== undefined && this.lacks(attribute.name) ? attribute.name : null;
  }

  private overlay(is: boolean): void {
    this.choices.presentation.over = is ? OVERLAID : null;
    this.choices.presentation.apply();
    this.follow();
  }

  private async occlude(): Promise<void> {
    const { light: { occlusion: isWanted } } = this.choices.chosen;
    if (isWanted === (this.occlusion !== null)) return;
    if (!isWanted) {
      this.view.unregisterPlugin(this.occlusion!);
      this.occlusion = null;
      return;
    }
    const { Occlusion } = await import('../../src/plugins/occlusion.js');
    if (this.context.signal.aborted || this.occlusion !== null || !this.choices.chosen.light.occlusion) return;
    this.occlusion = new Occlusion('pair occlusion');
    this.view.registerPlugin(this.occlusion);
  }

  /// Each side has the depth range and the light that it would have alone.
  private prepare(side: Side | null): void {
    const { canvas } = this.context;
    const view = this.pair.views[side ?? 0];
    canvas.reach(side === null ? this.pair.box : worldBox(view));
    const { rig, key } = shownOf(this.chosen(side ?? 0), view);
    canvas.lighting.set(rig, key);
  }

  private align(on: boolean): void {
    this.pair.aligned = on;
    this.showBar();
    this.context.redraw();
  }

  private showBar(): void {
    const { pair, blinking } = this;
    this.bar.show(pair.way, pair.shown, blinking.isOn);
    if (pair.isReady) this.bar.tell({ laying: pair.laying, overlaps: pair.overlaps, aligned: pair.aligned, lacks: this.lackedAttribute() });
  }
}

