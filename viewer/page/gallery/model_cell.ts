// SPDX-License-Identifier: MIT
// A model in the gallery: a link with its picture, its name and its size. The picture is the hierarchy's own; where it has none,
// its outline stands still. What is pointed at or focused shows its outline, which turns; if that stays so, its root tile does, shaded.
import { formatAddress, NOWHERE } from '../address.js';
import type { Model } from '../listing.js';
import { formatBytes, formatCount, formatDate, formatRough } from '../numbers.js';
import { element } from '../parts/element.js';
import { words } from '../words/words.js';
import type { Animation } from './animation.js';
import type { Cell } from './cell.js';
import type { Comparison } from './comparison.js';
import { drawOutline } from './drawing.js';
import type { DrawingQueue } from './drawing_queue.js';
import type { Turn } from './layout.js';
import { ModelSource, type Facts } from './model_source.js';
import type { Shape } from './shape.js';
import { Solid } from './solid.js';
import { Turning, type Turned } from './turning.js';

type Sizes = Pick<Facts, 'vertices' | 'triangles' | 'bytes'>;

/// Returns sizes as people read them.
function roughSizes({ triangles, bytes }: Sizes): string[] {
  const parts = [];
  if (triangles !== null) parts.push(words.counts.triangles(triangles, formatRough(triangles)));
  if (bytes !== null) parts.push(formatBytes(bytes));
  return parts;
}

function exactText({ name, source, modified, tags = [], warnings = [] }: Model, { vertices, triangles, bytes }: Sizes): string {
  const parts = [source ?? name];
  if (vertices !== null) parts.push(words.counts.vertices(vertices, formatCount(vertices)));
  if (triangles !== null) parts.push(words.counts.triangles(triangles, formatCount(triangles)));
  if (bytes !== null) parts.push(words.counts.bytes(bytes, formatCount(bytes)));
  if (modified !== null) parts.push(formatDate(modified));
  if (tags.length > 0) parts.push(tags.join(', '));
  return [...parts, ...warnings].join('\n');
}

/// All cells draw with these.
export interface Studio {
  stills: DrawingQueue;
  animation: Animation;
  comparison: Comparison;
}

export class ModelCell implements Cell, Turned {
  readonly root: HTMLLIElement;
  private readonly picture = element('img', { class: 'cell-picture', alt: '', decoding: 'async', draggable: 'false', hidden: true });
  private readonly canvas = element('canvas', { class: 'cell-outline', 'aria-hidden': 'true', hidden: true });
  private readonly note = element('span', { class: 'cell-note', hidden: true });
  private readonly stage = element('span', { class: 'cell-stage' }, this.picture, this.canvas, this.note);
  private readonly sizes = element('span', { class: 'cell-size' });
  private readonly link: HTMLAnchorElement;
  private readonly turning: Turning;
  private readonly source: ModelSource;
  private readonly solid: Solid;
  private shape: Shape | null = null;
  private pictured: 'unknown' | 'yes' | 'no' = 'unknown';

  constructor(readonly model: Model, private readonly studio: Studio) {
    this.source = new ModelSource(model.url);
    this.link = element(
      'a',
      { class: 'cell', href: formatAddress({ path: model.path, ...NOWHERE }), draggable: 'false' },
      this.stage,
      element('span', { class: 'cell-name' }, model.name),
      this.sizes,
    );
    this.showSizes(model);
    const { warnings = [] } = model;
    if (warnings.length > 0) this.stage.append(element('span', { class: 'cell-warning' }, words.counts.warnings(warnings.length, formatCount(warnings.length))));
    this.root = element('li', {}, this.link, studio.comparison.button(model));
    this.solid = new Solid(model.url, this.stage);
    this.turning = new Turning(this.link, this.stage, this);
  }

  /// As its outline is turned just now; null: it shows none.
  get turn(): Turn | null {
    return this.turning.lively && this.shape !== null ? this.turning.turn : null;
  }

  load(): void {
    if (this.pictured === 'unknown') void this.loadPicture();
    else if (this.pictured === 'no') this.askOutline();
    this.redraw();
  }

  redraw(): void {
    if (this.shape !== null && !this.canvas.hidden) this.studio.stills.add(this);
  }

  draw(): void {
    if (this.shape !== null) drawOutline(this.canvas, this.shape, this.turning.turn, getComputedStyle(this.canvas).color);
  }

  advance(angle: number): void {
    this.turning.advance(angle);
    if (!this.canvas.hidden) this.draw();
    this.solid.show(this.turning.turn);
  }

  close(): void {
    this.studio.animation.stop(this);
    this.solid.end();
    this.source.close();
    this.studio.comparison.forget(this.model);
    this.root.remove();
  }

  focus(): void {
    this.link.focus({ preventScroll: true });
  }

  private showSizes(sizes: Sizes): void {
    this.link.title = exactText(this.model, sizes);
    this.sizes.replaceChildren(...roughSizes(sizes).flatMap((text) => [element('span', {}, text), ' ']));
  }

  /// The hierarchy's own picture; where there is none, or it does not come, the outline.
  private async loadPicture(): Promise<void> {
    this.pictured = 'no';
    const url = await this.findPicture();
    if (url !== null && (await this.takePicture(url))) this.pictured = 'yes';
    else this.askOutline();
    this.arrange();
  }

  /// Where a listing tells nothing but the model's path, the manifest tells the picture, and the sizes.
  private async findPicture(): Promise<string | null> {
    if (this.model.preview !== null || this.model.vertices !== null) return this.model.preview;
    const facts = await this.source.facts().catch(() => null);
    if (facts !== null) this.showSizes(facts);
    return facts?.preview ?? null;
  }

  private async takePicture(url: string): Promise<boolean> {
    this.picture.src = url;
    return this.picture.decode().then(() => true, () => false);
  }

  /// Nothing happens while it is on its way, once it is there, and where it failed too often.
  private askOutline(): void {
    const asked = this.source.outline();
    if (asked === null) return;
    this.note.hidden = true;
    this.stage.classList.toggle('waiting', this.pictured === 'no');
    asked
      .then((shape) => { this.take(shape); }, (error: unknown) => { this.tell(error instanceof Error ? error.message : String(error)); })
      .finally(() => { this.stage.classList.remove('waiting'); });
  }

  private take(shape: Shape): void {
    this.shape = shape;
    this.turning.start(shape.first);
    if (this.turning.lively) this.solid.await(shape, this.turning.turn);
    if (shape.ends.length === 0) this.say(words.gallery.onePiece, false);
    this.arrange();
  }

  private tell(problem: string): void {
    if (!this.source.ended) this.say(words.gallery.noOutline(problem), true);
    this.arrange();
  }

  private say(text: string, isProblem: boolean): void {
    this.note.textContent = text;
    this.note.classList.toggle('cell-problem', isProblem);
    this.note.hidden = false;
  }

  enlivened(lively: boolean): void {
    if (lively) this.askOutline();
    if (!lively) this.solid.end();
    else if (this.shape !== null) this.solid.await(this.shape, this.turning.turn);
    if (lively) this.studio.animation.start(this);
    else this.studio.animation.stop(this);
    this.arrange();
  }

  turned(): void {
    this.askOutline();
    this.solid.show(this.turning.turn);
    this.redraw();
  }

  /// Which of picture, outline and note is to be seen.
  private arrange(): void {
    const hasPicture = this.pictured === 'yes';
    const outlined = this.shape !== null && this.shape.ends.length > 0 && (this.turning.lively || !hasPicture);
    this.stage.classList.toggle('lively', this.turning.lively);
    this.picture.hidden = !hasPicture || outlined;
    this.canvas.hidden = !outlined;
    if (hasPicture) this.note.hidden = true;
    this.redraw();
  }
}
