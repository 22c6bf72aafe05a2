// SPDX-License-Identifier: MIT
// The things that the model consists of: what one is called, found by name, left out or shown alone.
import type { ObjectRow } from '../../src/hierarchy/object_blocks.js';
import type { ObjectTable } from '../../src/hierarchy/object_table.js';
import { Objects } from '../../src/plugins/objects.js';
import { ALL_OBJECTS, alone, visibilityOf, withShown, type ObjectChoice } from '../../src/tools/object_choice.js';
import { fittingNames, type FoundNames } from '../../src/tools/object_names.js';
import { formatCount } from '../numbers.js';
import { element } from '../parts/element.js';
import { FigureList, textButton } from './figures.js';
import { objectLines } from './object_card.js';
import { ObjectColouring } from './object_colouring.js';
import { formatObjectLink, parseObjectLink } from './object_link.js';
import { ObjectSearch } from './object_search.js';
import { ObjectTree } from './object_tree.js';
import type { Tool } from './tool.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';
import './objects.css';

const AGAIN = 500; // milliseconds between two taps that are one
const NEAR = 0.06; // of half a picture, between their places

/// The name, and the branches that it is in: "a/b/c" is in "a/b/" and in "a/".
function scopesOf(name: string): string[] {
  const branches = [...name.matchAll(/\//g)].map(({ index }) => name.slice(0, index + 1)).filter((branch) => branch !== name);
  return [name, ...branches.reverse()];
}

export class ObjectsTool implements Tool {
  readonly root: HTMLElement;
  private readonly objects = new Objects({ name: 'page objects', isAlone: false });
  private readonly search = new ObjectSearch((...asked) => this.suggest(...asked), (row) => { this.find(row); });
  private readonly card = new FigureList(false);
  private readonly note = element('p', { class: 'tool-note', 'aria-live': 'polite' });
  private readonly scope = element('select', { class: 'tool-select', 'aria-label': words.objects.scope });
  private readonly acts: HTMLElement;
  private readonly colouring: ObjectColouring;
  private readonly all = textButton(words.objects.all, () => { this.draw(ALL_OBJECTS); });
  private readonly tree: ObjectTree;
  private readonly browser: HTMLDetailsElement;
  private tapped = { at: -Infinity, right: 0, up: 0 };
  private problem = '';
  private scoped: ObjectRow | null = null;
  private following = 0; // links
  private reading = 0; // properties

  constructor(private readonly shop: Workshop) {
    const { objects: text } = words;
    const { bench: { view } } = shop;
    view.registerPlugin(this.objects);
    this.objects.addEventListener('change', () => { this.show(); });
    this.objects.addEventListener('problem', ({ message }) => { this.fail(message); });
    this.objects.addEventListener('reading', ({ done, all }) => { this.colouring.tellReading(done / all); });
    this.colouring = new ObjectColouring(view.objects?.properties ?? [], (name) => void this.colour(name), (range) => { this.objects.colourRange(range); });
    const hide = textButton(text.hide, () => { this.draw(withShown(this.objects.choice, this.scope.value, false)); });
    const only = textButton(text.only, () => { this.draw(alone(this.objects.choice, this.scope.value)); });
    const go = textButton(text.go, () => { this.objects.go(); });
    this.acts = element('div', { class: 'object-acts' }, element('label', { class: 'tool-field' }, text.scope, this.scope), go, hide, only);
    this.tree = this.makeTree();
    this.browser = element('details', { class: 'tool-extra object-browser' }, element('summary', {}, text.browse), this.tree.root);
    this.browser.addEventListener('toggle', () => void this.browse());
    this.root = element('div', {}, this.search.root, this.browser, this.note, this.acts, this.card.root, this.all, this.colouring.root);
    // The browser tells a double click from two also while frames take long.
    shop.bench.surface.addEventListener('dblclick', () => { if (this.root.isConnected) this.objects.go(); }, { signal: shop.bench.signal });
    shop.link('objects').onFollow(() => void this.follow());
    void this.follow();
  }

  choose(right: number, up: number): void {
    this.problem = '';
    void this.pick(right, up);
  }

  /// Takes back what was left out last, then the choice of an object.
  undo(): boolean {
    const { choice: { hidden, only, shown }, picked } = this.objects;
    if (hidden.length > 0) this.draw({ hidden: hidden.slice(0, -1), shown: [] });
    else if (only.length > 0) this.draw({ only: [], shown: [] });
    else if (shown.length > 0) this.draw({ shown: [] });
    else if (picked !== null) this.objects.choose(null);
    else return false;
    return true;
  }

  lasting(): string | null {
    const { hidden, only } = this.objects.choice;
    return hidden.length + only.length > 0 ? words.objects.lasting : null;
  }

  end(): void {
    this.draw(ALL_OBJECTS);
  }

  private get table(): ObjectTable | null {
    return this.shop.bench.view.objects;
  }

  private async suggest(text: string, most: number, signal: AbortSignal): Promise<FoundNames> {
    this.problem = '';
    const none = { rows: [], hasMore: false };
    try {
      return this.table === null ? none : await fittingNames(this.table, text, most, signal);
    } catch (problem) {
      if (!signal.aborted) this.fail(problem);
      return none;
    }
  }

  private fail(problem: unknown): void {
    this.problem = problem instanceof Error ? problem.message : String(problem);
    this.show();
  }

  private makeTree(): ObjectTree {
    return new ObjectTree({
      visibility: (text) => visibilityOf(this.objects.choice, text),
      show: (text, isShown) => { this.draw(withShown(this.objects.choice, text, isShown)); },
      alone: (text) => { this.draw(alone(this.objects.choice, text)); },
      fly: (node) => void this.objects.goTo(node),
      pick: (object) => void this.objects.chooseObject(object),
      failed: (problem) => { this.fail(problem); },
    });
  }

  /// The tree is read while it is seen, and shows where the picked object is.
  private async browse(): Promise<void> {
    const { table, browser } = this;
    if (!browser.open || table === null) return;
    await this.tree.open(table);
    if (this.objects.picked !== null) await this.tree.reveal(this.objects.picked.object);
  }

  private async colour(name: string | null, range: readonly [number, number] | null = null): Promise<void> {
    ++this.reading;
    await this.objects.colourBy(name, undefined, range);
    if (--this.reading === 0) this.colouring.tellReading(null);
  }

  /// The second tap at a place flies to what is there.
  private async pick(right: number, up: number): Promise<void> {
    const { tapped } = this;
    this.tapped = { at: performance.now(), right, up };
    const isAgain = this.tapped.at - tapped.at < AGAIN && Math.hypot(right - tapped.right, up - tapped.up) < NEAR;
    if (isAgain && this.objects.picked !== null) this.objects.go();
    else if ((await this.objects.pick(right, up)) !== null && isAgain) this.objects.go();
  }

  private find(row: ObjectRow): void {
    this.objects.choose(row);
    this.objects.go();
  }

  private draw(choice: Partial<ObjectChoice>): void {
    this.problem = '';
    void this.objects.draw(choice);
  }

  /// As a link says, which stays as it is meanwhile.
  private async follow(): Promise<void> {
    const { picked, by, between, hidden, only, shown } = parseObjectLink(this.shop.link('objects').text);
    ++this.following;
    await Promise.all([this.objects.draw({ hidden, only, shown }), this.colour(by, between), picked === null ? this.objects.choose(null) : this.objects.chooseNamed(picked)]);
    --this.following;
    this.show();
  }

  private show(): void {
    const { picked, choice: { hidden, only, shown } } = this.objects;
    this.acts.hidden = picked === null;
    if (picked !== this.scoped) this.showPicked(picked);
    this.colouring.show(this.objects.legend);
    this.tree.update();
    this.all.hidden = hidden.length + only.length + shown.length === 0;
    this.note.textContent = this.problem !== '' ? this.problem : picked === null ? words.objects.hint(formatCount(this.table?.count ?? 0)) : '';
    if (this.following === 0) this.shop.link('objects').write(this.link());
    this.shop.bench.redraw();
  }

  private showPicked(picked: ObjectRow | null): void {
    this.scoped = picked;
    this.scope.replaceChildren(...(picked === null ? [] : scopesOf(picked.name)).map((name) => element('option', { value: name }, name === '' ? words.objects.noName : name)));
    this.card.show(objectLines(picked, this.table?.properties ?? [], this.shop.scale));
    void this.browse();
  }

  private link(): string {
    const { picked, legend, choice } = this.objects;
    const between = legend === null || legend.range === legend.whole ? null : legend.range;
    return formatObjectLink({ picked: picked?.name ?? null, by: legend?.property.name ?? null, between, ...choice });
  }
}

export function makeTool(shop: Workshop): Tool {
  return new ObjectsTool(shop);
}
