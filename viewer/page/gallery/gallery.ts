// SPDX-License-Identifier: MIT
// The thumbnail preview: all models as pictures, in groups, and the meshes that are becoming some.
import type { Job, Listing, Model, ModelSpot } from '../listing.js';
import { formatCount } from '../numbers.js';
import type { Page } from '../page.js';
import { element } from '../parts/element.js';
import { languageSelect } from '../parts/language_select.js';
import { themeButton } from '../parts/theme_button.js';
import { words } from '../words/words.js';
import { Animation } from './animation.js';
import { arrangeModels, arrangeSlots, findJobs, tagsOf, type Group } from './arrangement.js';
import type { Cell } from './cell.js';
import { Comparison } from './comparison.js';
import './comparison.css';
import { DrawingQueue } from './drawing_queue.js';
import { JobCell } from './job_cell.js';
import type { Turn } from './layout.js';
import { MapPlace } from './map_place.js';
import { ModelCell } from './model_cell.js';
import { PagedModels } from './paged_models.js';
import { SlotCell } from './slot_cell.js';
import { Toolbar } from './toolbar.js';
import { VisibleCells } from './visible_cells.js';
import type { Wish } from './wish.js';

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

/// A model that is not known yet, by its number.
interface SlotItem {
  key: string;
  slot: number;
}

function itemOf(model: Model): ModelItem {
  return { key: `model ${model.path}`, model };
}

/// What a gallery asks for.
export interface GallerySource {
  /// Something else is looked for: a listing that is a part of a longer one is to be fetched anew.
  readonly wished: () => void;
  /// Fetches what a wish finds from a model on; rejects where it cannot.
  readonly fetchPart: (wish: Wish, first: number, state: string, signal: AbortSignal) => Promise<Listing>;
  /// Resolves with where all models lie that a wish finds.
  readonly fetchPlaces: (wish: Wish, signal: AbortSignal) => Promise<readonly ModelSpot[]>;
}

export class Gallery {
  readonly root: HTMLElement;
  private readonly note = element('p', { class: 'gallery-note', 'aria-live': 'polite' });
  private readonly toolbar: Toolbar;
  private readonly visible = new VisibleCells<ModelItem | SlotItem | JobItem>((entry) => this.cellOf(entry));
  private readonly map: MapPlace;
  private readonly above = new ResizeObserver(() => { if (this.open) this.visible.follow(); }); // cells move with what is above
  private readonly animation = new Animation();
  private readonly comparison = new Comparison();
  private readonly stills = new DrawingQueue();
  private readonly cells = new Map<string, ModelCell>(); // the last one was used last
  private readonly jobCells = new Map<string, JobCell>();
  private listing: Pick<Listing, 'models' | 'jobs'> = { models: [], jobs: null };
  private paged: PagedModels | null = null; // of a server that finds models itself
  private pagedWish: Wish | null = null;
  private readonly slotCells = new Map<number, SlotCell>();
  private groups: readonly Group<Model>[] = [];
  private open = false;
  private scrolled = 0;

  constructor(page: Page, private readonly source: GallerySource) {
    this.toolbar = new Toolbar(page.preferences.order, () => {
      page.keep({ order: this.toolbar.wish.order });
      if (this.paged === null) this.arrange();
      else source.wished();
    }, (on) => { this.showMap(on); });
    this.map = new MapPlace((indices) => this.modelsAt(indices));
    page.addEventListener('theme', () => { this.visible.redraw(); });
    const header = element('header', { class: 'gallery-header' }, element('h1', {}, 'meshhier'), this.toolbar.root, languageSelect(page), themeButton(page));
    this.root = element('main', { class: 'gallery', hidden: true }, header, this.note, this.map.root, this.visible.root, this.comparison.root);
    document.addEventListener('keydown', (event) => { if (this.open) this.key(event); }, { capture: true });
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

  /// What is looked for.
  get wish(): Wish {
    return this.toolbar.wish;
  }

  /// Shows what the listing has; cells of models that stay keep what they show.
  update(listing: Listing): void {
    const { models, jobs, part } = listing;
    const isSame = part === null && this.paged === null && JSON.stringify(models) === JSON.stringify(this.listing.models);
    this.listing = { models: isSame ? this.listing.models : models, jobs };
    this.toolbar.root.hidden = (part?.total ?? models.length) < LEAST_SEARCHED;
    if (!isSame && part === null) this.dropOthers(models);
    this.updateJobs(jobs ?? []);
    const isPaged = this.page(listing);
    if (isSame || isPaged) this.showGroups();
    else this.arrange();
  }

  /// Takes the first part of a longer listing. True: it is the same one as before.
  private page({ part, models }: Listing): boolean {
    const { wish } = this;
    if (part !== null && part.state === this.paged?.part.state && wish === this.pagedWish) return true;
    this.paged?.close();
    this.slotCells.clear();
    const { fetchPart, wished } = this.source;
    this.paged = part === null ? null : new PagedModels(part, models, (...asked) => fetchPart(wish, ...asked), () => { this.showGroups(); }, wished);
    this.pagedWish = wish;
    return false;
  }

  private arrange(): void {
    const { listing: { models }, paged } = this;
    if (paged === null) this.groups = arrangeModels(models, this.toolbar.wish);
    this.toolbar.offer(paged?.part.tags ?? tagsOf(models), paged?.part.placed ?? models.filter(({ place }) => place).length);
    this.showGroups();
    if (this.map.shown) this.showMap(true);
  }

  /// A map in the place of the models.
  private showMap(on: boolean): void {
    this.visible.root.hidden = on;
    if (!on) {
      this.map.hide();
      this.visible.follow();
      return;
    }
    const spots = this.found().flatMap(({ place }, i): ModelSpot[] => (place === undefined ? [] : [[...place, i]]));
    void this.map.show(this.paged === null ? () => Promise.resolve(spots) : (signal) => this.source.fetchPlaces(this.wish, signal));
  }

  /// All models that are found, of a listing that has all.
  private found(): readonly Model[] {
    return this.groups.flatMap(({ items }) => items);
  }

  private async modelsAt(indices: readonly number[]): Promise<readonly Model[]> {
    if (this.paged !== null) return this.paged.at(indices);
    const found = this.found();
    return indices.flatMap((index) => found[index] ?? []);
  }

  /// A slash leads to the search, and down from there to the models; arrows with Shift from cell to cell.
  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    const isField = target.matches('input, select, textarea');
    const isSearch = target.matches('.search');
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    let done = true;
    if (event.key === '/' && !isField) this.toolbar.focus();
    else if (event.key === 'ArrowDown' && isSearch) this.visible.focusFirst();
    else if (!isField && !this.map.shown && (event.shiftKey || ['Home', 'End'].includes(event.key))) done = this.visible.step(event.key);
    else done = false;
    if (!done) return;
    event.preventDefault();
    event.stopPropagation();
  }

  private showGroups(): void {
    const jobs = findJobs(this.listing.jobs ?? [], this.toolbar.wish);
    const underWay = { key: 'jobs', name: '', items: jobs.map((job) => ({ key: `job ${job.name}`, job })) };
    const models = this.modelGroups();
    this.visible.show([underWay, ...models].filter(({ items }) => items.length > 0));
    this.tell(this.summary());
  }

  private modelGroups(): Group<ModelItem | SlotItem>[] {
    const { paged } = this;
    if (paged === null) return this.groups.map(({ key, name, items }) => ({ key, name, items: items.map(itemOf) }));
    return arrangeSlots(paged.slots.map((model, slot) => (model === null ? { key: `slot ${slot}`, slot } : itemOf(model))), paged.part);
  }

  private summary(): string {
    const { search, tag } = this.toolbar.wish;
    const all = this.paged?.part.total ?? this.listing.models.length;
    const found = this.paged?.part.found ?? this.groups.reduce((sum, { items }) => sum + items.length, 0);
    const total = words.counts.models(all, formatCount(all));
    if (search === '' && tag === '') return total;
    return found === 0 ? words.gallery.nothingFound([search, tag].filter((text) => text !== '').join(', ')) : words.gallery.found(formatCount(found), total);
  }

  private cellOf(entry: ModelItem | SlotItem | JobItem): Cell {
    return 'model' in entry ? this.modelCell(entry) : 'job' in entry ? this.jobCell(entry) : this.slotCell(entry);
  }

  private slotCell({ slot }: SlotItem): Cell {
    const cell = this.slotCells.get(slot) ?? new SlotCell(() => { this.paged?.need(slot); });
    this.slotCells.set(slot, cell);
    return cell;
  }

  /// The model's cell; a new one if it is not as it was.
  private modelCell({ key, model }: ModelItem): Cell {
    const known = this.cells.get(key);
    if (known !== undefined && known.model !== model && JSON.stringify(known.model) !== JSON.stringify(model)) this.drop(key);
    const cell = this.cells.get(key) ?? new ModelCell(model, { stills: this.stills, animation: this.animation, comparison: this.comparison });
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
