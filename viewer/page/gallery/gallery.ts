// SPDX-License-Identifier: MIT
// The thumbnail preview: all models as pictures, in groups, and the meshes that are becoming some.
import type { Job, Listing, Model } from '../listing.js';
import { formatCount } from '../numbers.js';
import type { Page } from '../page.js';
import { element } from '../parts/element.js';
import { languageSelect } from '../parts/language_select.js';
import { themeButton } from '../parts/theme_button.js';
import { words } from '../words/words.js';
import { Animation } from './animation.js';
import { arrangeModels, findJobs, type Group } from './arrangement.js';
import type { Cell } from './cell.js';
import { DrawingQueue } from './drawing_queue.js';
import { JobCell } from './job_cell.js';
import type { Turn } from './layout.js';
import { ModelCell } from './model_cell.js';
import { Toolbar } from './toolbar.js';
import { VisibleCells } from './visible_cells.js';

const MOST_KEPT = 400; // cells of models, of which the window shows a few dozen: what was seen comes back as it was
const LEAST_SEARCHED = 2; // models

interface ModelItem {
  key: string;
  model: Model;
}

interface JobItem {
  key: string;
  job: Job;
}

function itemOf(model: Model): ModelItem {
  return { key: `model ${model.path}`, model };
}

export class Gallery {
  readonly root: HTMLElement;
  private readonly note = element('p', { class: 'gallery-note', 'aria-live': 'polite' });
  private readonly toolbar: Toolbar;
  private readonly visible = new VisibleCells<ModelItem | JobItem>((entry) => ('model' in entry ? this.modelCell(entry) : this.jobCell(entry)));
  private readonly above = new ResizeObserver(() => { if (this.open) this.visible.follow(); }); // cells move with what is above
  private readonly animation = new Animation();
  private readonly stills = new DrawingQueue();
  private readonly cells = new Map<string, ModelCell>(); // the last one was used last
  private readonly jobCells = new Map<string, JobCell>();
  private listing: Pick<Listing, 'models' | 'jobs'> = { models: [], jobs: null };
  private groups: readonly Group<Model>[] = [];
  private open = false;
  private scrolled = 0;

  constructor(page: Page) {
    this.toolbar = new Toolbar(page.preferences.order, () => {
      page.keep({ order: this.toolbar.wish.order });
      this.arrange();
    });
    page.addEventListener('theme', () => { this.visible.redraw(); });
    const header = element('header', { class: 'gallery-header' }, element('h1', {}, 'meshhier'), this.toolbar.root, languageSelect(page), themeButton(page));
    this.root = element('main', { class: 'gallery', hidden: true }, header, this.note, this.visible.root);
    for (const type of ['scroll', 'resize'] as const) window.addEventListener(type, () => { if (this.open) this.visible.follow(); }, { passive: true });
    this.toolbar.root.hidden = true;
  }

  get shown(): boolean {
    return this.open;
  }

  /// Puts something above the models, of whatever height.
  insert(section: HTMLElement): void {
    this.note.before(section);
    this.above.observe(section);
  }

  show(): void {
    this.open = true;
    this.root.hidden = false;
    this.visible.follow();
    window.scrollTo(0, this.scrolled);
    this.visible.follow();
  }

  hide(): void {
    if (this.open) this.scrolled = window.scrollY;
    this.open = false;
    this.root.hidden = true;
    this.animation.stopAll();
  }

  /// Focuses the cell of that path, if there is one.
  focus(path: string): void {
    const cell = this.visible.reveal(`model ${path}`);
    if (cell instanceof ModelCell) cell.focus();
  }

  /// As the model of that path is turned in its cell; null: it is not.
  turnOf(path: string): Turn | null {
    return this.cells.get(`model ${path}`)?.turn ?? null;
  }

  /// A text in the place of the models, or above them. The same one again is not read out again.
  tell(text: string): void {
    if (this.note.textContent !== text) this.note.textContent = text;
  }

  /// Shows what the listing has; cells of models that stay keep what they show.
  update({ models, jobs }: Listing): void {
    const isSame = JSON.stringify(models) === JSON.stringify(this.listing.models);
    this.listing = { models: isSame ? this.listing.models : models, jobs };
    this.toolbar.root.hidden = models.length < LEAST_SEARCHED;
    if (!isSame) this.dropOthers(models);
    this.updateJobs(jobs ?? []);
    if (isSame) this.showGroups();
    else this.arrange();
  }

  private arrange(): void {
    this.groups = arrangeModels(this.listing.models, this.toolbar.wish);
    this.showGroups();
  }

  private showGroups(): void {
    const jobs = findJobs(this.listing.jobs ?? [], this.toolbar.wish);
    const underWay = { key: 'jobs', name: '', items: jobs.map((job) => ({ key: `job ${job.name}`, job })) };
    const models = this.groups.map(({ key, name, items }) => ({ key, name, items: items.map(itemOf) }));
    this.visible.show([underWay, ...models].filter(({ items }) => items.length > 0));
    this.tell(this.summary());
  }

  private summary(): string {
    const { search } = this.toolbar.wish;
    const all = this.listing.models.length;
    const found = this.groups.reduce((sum, { items }) => sum + items.length, 0);
    const total = words.counts.models(all, formatCount(all));
    if (search === '') return total;
    return found === 0 ? words.gallery.nothingFound(search) : words.gallery.found(formatCount(found), total);
  }

  /// The model's cell; a new one if it is not as it was.
  private modelCell({ key, model }: ModelItem): Cell {
    const cell = this.cells.get(key) ?? new ModelCell(model, { stills: this.stills, animation: this.animation });
    this.cells.delete(key);
    this.cells.set(key, cell);
    if (this.cells.size > MOST_KEPT) this.drop(this.cells.keys().next().value!);
    return cell;
  }

  private drop(key: string): void {
    this.cells.get(key)?.close();
    this.cells.delete(key);
  }

  /// Cells of models that are gone, or others by now.
  private dropOthers(models: readonly Model[]): void {
    const now = new Map(models.map((model) => [itemOf(model).key, model]));
    for (const [key, { model }] of [...this.cells]) if (JSON.stringify(model) !== JSON.stringify(now.get(key))) this.drop(key);
  }

  private jobCell({ job }: JobItem): Cell {
    const cell = this.jobCells.get(job.name) ?? new JobCell(job.name);
    this.jobCells.set(job.name, cell);
    cell.update(job);
    return cell;
  }

  private updateJobs(jobs: readonly Job[]): void {
    const names = new Set(jobs.map(({ name }) => name));
    for (const [name, cell] of [...this.jobCells]) {
      if (names.has(name)) continue;
      cell.close();
      this.jobCells.delete(name);
    }
  }
}
