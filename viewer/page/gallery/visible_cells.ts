// SPDX-License-Identifier: MIT
// Keeps cells near the window, of thousands: only these are elements of the page, which is as high as all of them.
import { element } from '../parts/element.js';
import type { Group } from './arrangement.js';
import type { Cell } from './cell.js';
import { Grid, type Metrics } from './grid.js';

const NEAR = 400; // CSS pixels above and below the window
const DWELL = 100; // milliseconds near the window before a cell loads: those that fly past ask for nothing
const NARROW = 480;

function metricsOf(width: number): Metrics {
  const narrow = width < NARROW;
  return { width, leastWidth: narrow ? 150 : 220, gap: narrow ? 10 : 14, textHeight: narrow ? 78 : 60, headingHeight: 48 };
}

/// Makes `children` the children of `parent`; those that are in place are not touched, and keep the focus.
function arrange(parent: Element, children: readonly Element[]): void {
  const kept = new Set(children);
  for (const child of [...parent.children]) if (!kept.has(child)) child.remove();
  children.forEach((child, i) => {
    if (parent.children[i] !== child) parent.insertBefore(child, parent.children[i] ?? null);
  });
}

/// A group on the page: its name, and a list of some of its cells.
class Band {
  readonly root: HTMLElement;
  readonly list = element('ul', { class: 'cells', role: 'list' });

  constructor(readonly name: string) {
    const heading = name === '' ? null : element('h2', { class: 'group-name', title: name }, name);
    this.root = element('section', { class: 'group', 'aria-label': name || null }, heading, this.list);
  }
}

interface CellSpot {
  group: number;
  item: number;
}

/// Something that has a cell; no two have the same key.
export interface Entry {
  readonly key: string;
}

export class VisibleCells<One extends Entry> {
  readonly root = element('div', { class: 'groups' });
  private groups: readonly Group<One>[] = [];
  private spots = new Map<string, CellSpot>(); // of all entries, by key
  private grid = new Grid([], metricsOf(0));
  private width = 0;
  private readonly bands = new Map<string, Band>(); // by their groups' keys
  private readonly keys = new WeakMap<Element, string>(); // of all cells that were ever shown
  private shown = new Map<Cell, number>(); // with the timers of those that are to load

  /// `cellOf`: an entry's own cell, the same one each time while it is shown.
  constructor(private readonly cellOf: (entry: One) => Cell) {}

  /// In the places of what was shown before.
  show(groups: readonly Group<One>[]): void {
    this.groups = groups;
    this.spots = new Map(groups.flatMap(({ items }, group) => items.map(({ key }, item) => [key, { group, item }])));
    this.dropBands();
    this.measure();
    this.follow();
  }

  /// After each scroll, and each change of the window.
  follow(): void {
    const { top, width } = this.root.getBoundingClientRect();
    if (width === 0) return;
    if (width !== this.width) this.resize();
    this.fill(-top - NEAR, window.innerHeight - top + NEAR);
  }

  /// Scrolls to an entry, so that its cell is an element of the page. Null: it is not shown.
  reveal(key: string): Cell | null {
    const spot = this.spots.get(key);
    if (spot === undefined) return null;
    const place = this.grid.bandOf(spot.group).top + this.grid.placeOf(spot).top + this.root.getBoundingClientRect().top;
    const isInWindow = place >= 0 && place + this.grid.cellHeight <= window.innerHeight;
    if (!isInWindow) window.scrollBy(0, place - (window.innerHeight - this.grid.cellHeight) / 2);
    this.follow();
    return this.cellOf(this.entryAt(spot));
  }

  focusFirst(): void {
    this.focusAt(0);
  }

  /// Moves the focus from a cell by a key: arrows, Home, End. False: no cell has it, or the key says nothing.
  step(key: string): boolean {
    const focused = this.focused();
    const step = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: -this.grid.columns, ArrowDown: this.grid.columns }[key];
    if (focused === undefined || (step === undefined && key !== 'Home' && key !== 'End')) return false;
    const before = this.groups.slice(0, focused.group).reduce((sum, { items }) => sum + items.length, 0);
    const last = this.spots.size - 1;
    this.focusAt(step === undefined ? (key === 'Home' ? 0 : last) : Math.min(Math.max(before + focused.item + step, 0), last));
    return true;
  }

  /// Focuses a cell, counted over all groups; one that cannot have the focus yet is only shown.
  private focusAt(index: number): void {
    let group = 0;
    let item = index;
    while (group < this.groups.length && item >= this.groups[group].items.length) item -= this.groups[group++].items.length;
    const entry = this.groups[group]?.items[item];
    if (entry !== undefined) this.reveal(entry.key)?.root.querySelector('a')?.focus({ preventScroll: true });
  }

  redraw(): void {
    for (const cell of this.shown.keys()) cell.redraw();
  }

  /// Those of groups that are gone, or have another name by now.
  private dropBands(): void {
    const names = new Map(this.groups.map(({ key, name }) => [key, name]));
    for (const [key, { name }] of [...this.bands]) if (names.get(key) !== name) this.bands.delete(key);
  }

  private entryAt({ group, item }: CellSpot): One {
    return this.groups[group].items[item];
  }

  private resize(): void {
    this.measure();
    this.redraw();
  }

  private measure(): void {
    this.width = this.root.getBoundingClientRect().width;
    this.grid = new Grid(this.groups.map(({ name, items }) => ({ count: items.length, hasHeading: name !== '' })), metricsOf(this.width));
    this.root.style.height = `${this.grid.height}px`;
  }

  private fill(top: number, bottom: number): void {
    const before = this.shown;
    this.shown = new Map();
    const wanted = this.wanted(top, bottom);
    const groups = [...wanted.keys()].sort((a, b) => a - b);
    arrange(this.root, groups.map((group) => this.showBand(group, wanted.get(group)!, before).root));
    for (const [cell, timer] of before) if (!this.shown.has(cell)) window.clearTimeout(timer);
  }

  /// Returns the cells to be shown of each group that is near the window. The one that has the focus keeps it, wherever it is.
  private wanted(top: number, bottom: number): Map<number, Set<number>> {
    const wanted = new Map<number, Set<number>>();
    for (const { group, first, end } of this.grid.runsBetween(top, bottom))
      wanted.set(group, new Set(Array.from({ length: end - first }, (_, i) => first + i)));
    const focused = this.focused();
    if (focused !== undefined) wanted.set(focused.group, (wanted.get(focused.group) ?? new Set()).add(focused.item));
    return wanted;
  }

  private focused(): CellSpot | undefined {
    const key = this.keys.get(document.activeElement?.closest('li') ?? this.root);
    return key === undefined ? undefined : this.spots.get(key);
  }

  private showBand(group: number, items: Set<number>, before: ReadonlyMap<Cell, number>): Band {
    const { key, name } = this.groups[group];
    const band = this.bands.get(key) ?? new Band(name);
    this.bands.set(key, band);
    const { top, height } = this.grid.bandOf(group);
    Object.assign(band.root.style, { top: `${top}px`, height: `${height}px` });
    const cells = [...items].sort((a, b) => a - b).map((item) => this.showCell({ group, item }, before));
    arrange(band.list, cells.map(({ root }) => root));
    return band;
  }

  private showCell(spot: CellSpot, before: ReadonlyMap<Cell, number>): Cell {
    const entry = this.entryAt(spot);
    const cell = this.cellOf(entry);
    this.keys.set(cell.root, entry.key);
    this.place(cell.root, spot);
    this.shown.set(cell, before.get(cell) ?? window.setTimeout(() => { cell.load(); }, DWELL));
    return cell;
  }

  private place(root: HTMLElement, spot: CellSpot): void {
    const { left, top } = this.grid.placeOf(spot);
    const { cellWidth: width, cellHeight: height } = this.grid;
    Object.assign(root.style, { left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px` });
    root.setAttribute('aria-setsize', String(this.groups[spot.group].items.length));
    root.setAttribute('aria-posinset', String(spot.item + 1));
  }
}
