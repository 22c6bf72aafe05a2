// SPDX-License-Identifier: MIT
// The things that the model consists of: what one is called, found by name, left out or shown alone.
import type { ObjectProperty } from '../../src/hierarchy/object_facts.js';
import type { ObjectRow, ObjectValue } from '../../src/hierarchy/object_blocks.js';
import type { ObjectTable } from '../../src/hierarchy/object_table.js';
import { Objects, type ObjectChoice } from '../../src/plugins/objects.js';
import { fittingNames } from '../../src/tools/object_names.js';
import { formatCount } from '../numbers.js';
import { element } from '../parts/element.js';
import { figureList, figures, textButton } from './figures.js';
import { ObjectColouring } from './object_colouring.js';
import { formatObjectLink, parseObjectLink } from './object_link.js';
import { ObjectSearch } from './object_search.js';
import type { Tool } from './tool.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

const AGAIN = 500; // milliseconds between two taps that are one
const NEAR = 0.06; // of half a picture, between their places
const DIGITS = 12; // of a number in a table

function told(value: ObjectValue): string {
  if (typeof value === 'boolean') return value ? words.objects.yes : words.objects.no;
  return typeof value === 'number' ? String(Number(value.toPrecision(DIGITS))) : (value ?? '–');
}

function propertyRows(properties: readonly ObjectProperty[], { values }: ObjectRow): (readonly [string, string])[] {
  return properties.flatMap(({ name }, i) => (values[i] === null ? [] : [[name, told(values[i])] as const]));
}

/// The name, and the branches that it is in: "a/b/c" is in "a/b/" and in "a/".
function scopesOf(name: string): string[] {
  const branches = [...name.matchAll(/\//g)].map(({ index }) => name.slice(0, index + 1)).filter((branch) => branch !== name);
  return [name, ...branches.reverse()];
}

export class ObjectsTool implements Tool {
  readonly root: HTMLElement;
  private readonly objects = new Objects({ name: 'page objects', isAlone: false });
  private readonly search = new ObjectSearch((text, most) => this.suggest(text, most), (row) => { this.find(row); });
  private readonly list = figureList();
  private readonly note = element('p', { class: 'tool-note', 'aria-live': 'polite' });
  private readonly scope = element('select', { class: 'tool-select', 'aria-label': words.objects.scope });
  private readonly acts: HTMLElement;
  private readonly colouring: ObjectColouring;
  private readonly all = textButton(words.objects.all, () => { this.draw({ hidden: [], only: [] }); });
  private tapped = { at: -Infinity, right: 0, up: 0 };
  private problem = '';
  private scoped: ObjectRow | null = null;
  private following = 0; // links

  constructor(private readonly shop: Workshop) {
    const { objects: text } = words;
    const { bench: { view }, objectLink } = shop;
    view.registerPlugin(this.objects);
    this.objects.addEventListener('change', () => { this.show(); });
    this.objects.addEventListener('problem', ({ message }) => { this.problem = message; this.show(); });
    this.colouring = new ObjectColouring(view.objects?.properties ?? [], (name) => void this.objects.colourBy(name));
    const hide = textButton(text.hide, () => { this.draw({ hidden: [...new Set([...this.objects.choice.hidden, this.scope.value])] }); });
    const only = textButton(text.only, () => { this.draw({ only: [this.scope.value] }); });
    const go = textButton(text.go, () => { this.objects.go(); });
    this.acts = element('div', { class: 'object-acts' }, element('label', { class: 'tool-field' }, text.scope, this.scope), go, hide, only);
    this.root = element('div', {}, this.search.root, this.note, this.list, this.acts, this.all, this.colouring.root);
    // The browser tells a double click from two also while frames take long.
    shop.bench.surface.addEventListener('dblclick', () => { if (this.root.isConnected) this.objects.go(); }, { signal: shop.bench.signal });
    objectLink.onFollow(() => void this.follow());
    void this.follow();
  }

  choose(right: number, up: number): void {
    this.problem = '';
    void this.pick(right, up);
  }

  /// Takes back what was left out last, then the choice of an object.
  undo(): boolean {
    const { choice: { hidden, only }, picked } = this.objects;
    if (hidden.length > 0) this.draw({ hidden: hidden.slice(0, -1) });
    else if (only.length > 0) this.draw({ only: [] });
    else if (picked !== null) this.objects.choose(null);
    else return false;
    return true;
  }

  lasting(): string | null {
    const { hidden, only } = this.objects.choice;
    return hidden.length + only.length > 0 ? words.objects.lasting : null;
  }

  end(): void {
    this.draw({ hidden: [], only: [] });
  }

  private get table(): ObjectTable | null {
    return this.shop.bench.view.objects;
  }

  private async suggest(text: string, most: number): Promise<readonly ObjectRow[]> {
    this.problem = '';
    try {
      return this.table === null ? [] : await fittingNames(this.table, text, most);
    } catch (problem) {
      this.problem = problem instanceof Error ? problem.message : String(problem);
      this.show();
      return [];
    }
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
    const { picked, by, hidden, only } = parseObjectLink(this.shop.objectLink.text);
    ++this.following;
    await Promise.all([this.objects.draw({ hidden, only }), this.objects.colourBy(by), picked === null ? this.objects.choose(null) : this.objects.chooseNamed(picked)]);
    --this.following;
    this.show();
  }

  private show(): void {
    const { picked, legend, choice: { hidden, only } } = this.objects;
    this.list.replaceChildren(...(picked === null ? [] : figures(this.rowsOf(picked))));
    this.acts.hidden = picked === null;
    if (picked !== null && picked !== this.scoped) this.scope.replaceChildren(...scopesOf(picked.name).map((name) => element('option', { value: name }, name === '' ? words.objects.noName : name)));
    this.scoped = picked;
    this.colouring.show(legend);
    this.all.hidden = hidden.length + only.length === 0;
    this.note.textContent = this.problem !== '' ? this.problem : picked === null ? words.objects.hint(formatCount(this.table?.count ?? 0)) : '';
    if (this.following === 0) this.shop.objectLink.write(formatObjectLink({ picked: picked?.name ?? null, by: legend?.property.name ?? null, hidden, only }));
    this.shop.bench.redraw();
  }

  private rowsOf(row: ObjectRow): (readonly [string, string])[] {
    const { objects: text } = words;
    const { scale } = this.shop;
    const { box, triangles, area, name } = row;
    const sides = box?.max.map((most, axis) => scale.format(most - box.min[axis])) ?? [];
    const size = sides.map((side, axis) => (axis < 2 ? side.slice(0, side.lastIndexOf(` ${scale.sign}`)) : side)).join(' × '); // the unit once
    return [
      [text.name, name === '' ? text.noName : name], ...propertyRows(this.table?.properties ?? [], row), ...(box === null ? [] : [[text.size, size] as const]),
      [text.area, scale.formatArea(area)], [text.triangles, formatCount(triangles)],
    ];
  }
}

export function makeTool(shop: Workshop): Tool {
  return new ObjectsTool(shop);
}
