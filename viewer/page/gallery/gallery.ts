// The thumbnail preview: all models as outlines that turn.
import type { Job, Listing, Model } from '../listing.js';
import { formatCount } from '../numbers.js';
import { element } from '../parts/element.js';
import { words } from '../words/words.js';
import { JobCell } from './job_cell.js';
import { ModelCell } from './model_cell.js';
import { Painter } from './painter.js';

const RADIANS_A_MILLISECOND = 0.00035;
const LONGEST_STEP = 100; // milliseconds
const NEAR = '300px';

const still = matchMedia('(prefers-reduced-motion: reduce)');

/// Makes `children` the first children of `parent`; those that are in place are not touched, and keep the focus.
function arrange(parent: Element, children: readonly Element[]): void {
  children.forEach((child, i) => {
    if (parent.children[i] !== child) parent.insertBefore(child, parent.children[i] ?? null);
  });
}

export class Gallery {
  readonly root: HTMLElement;
  private readonly list = element('ul', { class: 'cells', role: 'list' });
  private readonly note = element('p', { class: 'gallery-note', 'aria-live': 'polite' });
  private readonly painter: Painter;
  private readonly near: IntersectionObserver;
  private readonly above = new ResizeObserver(() => { this.ask(); }); // the canvas does not move with the cells
  private readonly cells = new Map<string, ModelCell>();
  private readonly jobs = new Map<string, JobCell>();
  private readonly byRoot = new WeakMap<Element, ModelCell>();
  private readonly visible = new Set<ModelCell>();
  private frame = 0;
  private before = 0;
  private open = false;
  private scrolled = 0;

  constructor(header: HTMLElement) {
    const canvas = element('canvas', { class: 'gallery-canvas', 'aria-hidden': 'true' });
    this.root = element('main', { class: 'gallery', hidden: true }, header, this.note, this.list, canvas);
    this.painter = new Painter(canvas, () => { this.ask(); });
    this.near = new IntersectionObserver((entries) => { this.seen(entries); }, { rootMargin: NEAR });
    for (const type of ['scroll', 'resize'] as const) window.addEventListener(type, () => { this.ask(); }, { passive: true });
    document.addEventListener('visibilitychange', () => { this.ask(); });
    still.addEventListener('change', () => { this.ask(); });
  }

  get shown(): boolean {
    return this.open;
  }

  /// False: the browser has no WebGL 2, and cells stay empty.
  get works(): boolean {
    return this.painter.works;
  }

  /// Puts something above the models, of whatever height.
  insert(section: HTMLElement): void {
    this.note.before(section);
    this.above.observe(section);
  }

  show(): void {
    this.open = true;
    this.root.hidden = false;
    window.scrollTo(0, this.scrolled);
    this.ask();
  }

  hide(): void {
    if (this.open) this.scrolled = window.scrollY;
    this.open = false;
    this.root.hidden = true;
  }

  /// Focuses the cell of that path, if there is one.
  focus(path: string): void {
    this.cells.get(path)?.root.querySelector('a')?.focus({ preventScroll: true });
  }

  themeChanged(): void {
    this.painter.themeChanged();
    this.ask();
  }

  /// A text in the place of the models, or above them. The same one again is not read out again.
  tell(text: string): void {
    if (this.note.textContent !== text) this.note.textContent = text;
  }

  /// Shows what the listing has; cells of models that stay keep their outlines.
  update({ models, jobs }: Listing): void {
    this.updateJobs(jobs ?? []);
    this.updateModels(models);
    const cells = [...(jobs ?? []).map(({ name }) => this.jobs.get(name)!), ...models.map(({ path }) => this.cells.get(path)!)];
    arrange(this.list, cells.map(({ root }) => root));
    this.tell(words.counts.models(models.length, formatCount(models.length)));
    this.ask();
  }

  private updateModels(models: readonly Model[]): void {
    const kept = new Set(models.map((model) => this.cellOf(model)));
    for (const cell of this.cells.values()) if (!kept.has(cell)) this.drop(cell);
  }

  /// The model's cell; a new one if it is not as it was.
  private cellOf(model: Model): ModelCell {
    const before = this.cells.get(model.path);
    if (before !== undefined && JSON.stringify(before.model) === JSON.stringify(model)) return before;
    if (before !== undefined) this.drop(before);
    const cell = new ModelCell(model, () => { this.ask(); });
    this.cells.set(model.path, cell);
    this.byRoot.set(cell.root, cell);
    this.near.observe(cell.root);
    return cell;
  }

  private drop(cell: ModelCell): void {
    this.near.unobserve(cell.root);
    this.visible.delete(cell);
    cell.close();
    this.cells.delete(cell.model.path);
  }

  private updateJobs(jobs: readonly Job[]): void {
    const names = new Set(jobs.map(({ name }) => name));
    for (const [name, { root }] of this.jobs) {
      if (names.has(name)) continue;
      root.remove();
      this.jobs.delete(name);
    }
    for (const job of jobs) {
      const cell = this.jobs.get(job.name) ?? new JobCell(job.name);
      this.jobs.set(job.name, cell);
      cell.update(job);
    }
  }

  private seen(entries: readonly IntersectionObserverEntry[]): void {
    for (const { target, isIntersecting } of entries) {
      const cell = this.byRoot.get(target);
      if (cell === undefined) continue;
      if (isIntersecting) {
        this.visible.add(cell);
        cell.load();
      } else this.visible.delete(cell);
    }
    this.ask();
  }

  private ask(): void {
    if (this.frame === 0 && this.open && !document.hidden) this.frame = requestAnimationFrame((now) => { this.draw(now); });
  }

  private draw(now: number): void {
    this.frame = 0;
    if (!this.open) return;
    const angle = still.matches ? 0 : Math.min(now - this.before, LONGEST_STEP) * RADIANS_A_MILLISECOND;
    this.before = now;
    for (const cell of this.cells.values()) cell.advance(angle);
    const drawn = [...this.visible].filter(({ shape }) => shape !== null);
    this.painter.paint(drawn.map((cell) => ({
      shape: cell.shape!,
      place: cell.stage.getBoundingClientRect(),
      turn: cell.turn,
      lively: cell.lively,
    })));
    if (!still.matches && drawn.length > 0) this.ask();
  }
}
