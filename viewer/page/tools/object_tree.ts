// SPDX-License-Identifier: MIT
// The tree of objects' names, by hand, by key and by ear (the tree pattern of the ARIA practices): each level is read when it is opened, and rows
// follow each other in the page as they are seen.
import type { ObjectTable } from '../../src/hierarchy/object_table.js';
import { childrenOf, rootOf, type ObjectNode } from '../../src/hierarchy/object_tree.js';
import type { Visibility } from '../../src/tools/object_choice.js';
import { formatCount } from '../numbers.js';
import { element, icon } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { textButton } from './figures.js';
import { words } from './words/words.js';

const MOST_OPENED = 64; // levels that open by themselves
const TYPED_TOGETHER = 700; // milliseconds between letters of one word
const CHECKED: Readonly<Record<Visibility, string>> = { shown: 'true', hidden: 'false', mixed: 'mixed' };

/// What can be done with what a row stands for; a group's has no name.
export interface TreeActs {
  visibility(text: string): Visibility;
  show(text: string, isShown: boolean): void;
  alone(text: string): void;
  fly(node: ObjectNode): void;
  /// An object's row was chosen.
  pick(object: number): void;
  failed(problem: unknown): void;
}

interface Row {
  readonly node: ObjectNode;
  readonly level: number;
  readonly parent: Row | null;
  readonly root: HTMLElement;
  /// Null: it is closed.
  children: readonly Row[] | null;
}

function labelOf({ kind, label, text }: ObjectNode): string {
  return text === '' && kind === 'object' ? words.objects.noName : kind === 'group' ? `${label} …` : label;
}

export class ObjectTree {
  readonly root: HTMLElement;
  private readonly tree = element('div', { class: 'tree', role: 'tree', 'aria-label': words.objects.tree });
  private readonly show = textButton(words.objects.hide, () => { this.toggleShown(); });
  private readonly only = textButton(words.objects.only, () => { if (this.active !== null) this.acts.alone(this.active.node.text); });
  private readonly fly = textButton(words.objects.go, () => { if (this.active !== null) this.acts.fly(this.active.node); });
  private table: ObjectTable | null = null;
  private rows: readonly Row[] = [];
  private active: Row | null = null;
  private typed = { text: '', at: 0 };
  private revealing = 0;

  constructor(private readonly acts: TreeActs) {
    this.root = element('div', { class: 'object-tree' }, this.tree, element('div', { class: 'object-acts' }, this.fly, this.show, this.only));
    this.tree.addEventListener('keydown', (event) => { this.keyed(event); });
    this.tree.addEventListener('focusin', ({ target }) => { this.activate(this.rowAt(target as Element), false); });
    this.tree.addEventListener('click', ({ target }) => { this.clicked(target as Element); });
    this.tree.addEventListener('dblclick', () => { if (this.active !== null) this.acts.fly(this.active.node); });
  }

  /// Begins anew where it is another table.
  async open(table: ObjectTable): Promise<void> {
    if (table === this.table) return;
    this.table = table;
    [this.rows, this.active] = [[], null];
    this.tree.replaceChildren();
    const rows = await this.read(rootOf(table), null);
    if (table !== this.table) return;
    if (rows === null) {
      this.table = null; // it is read when it is opened again
      return;
    }
    this.tree.replaceChildren(...rows.map(({ root }) => root));
    this.rows = rows;
    this.activate(rows[0], false);
    if (rows.length === 1) await this.expand(rows[0]);
  }

  /// Opens the branches that an object is in, and makes its row the active one.
  async reveal(object: number): Promise<void> {
    const revealing = ++this.revealing;
    for (let rows: readonly Row[] | null = this.rows; rows !== null; ) {
      const row: Row | undefined = rows.find(({ node: { begin, end } }) => object >= begin && object < end);
      if (row === undefined || revealing !== this.revealing) return;
      if (row.node.kind === 'object') {
        this.activate(row, false);
        return;
      }
      await this.expand(row);
      rows = row.children;
    }
  }

  /// What is drawn has become another choice.
  update(): void {
    for (const row of this.all(this.rows)) this.showState(row);
    this.showActs();
  }

  private async read(node: ObjectNode, parent: Row | null): Promise<Row[] | null> {
    try {
      const nodes = await childrenOf(this.table!, node);
      return nodes.map((each, i) => this.makeRow(each, parent, i + 1, nodes.length));
    } catch (problem) {
      this.acts.failed(problem);
      return null;
    }
  }

  private makeRow(node: ObjectNode, parent: Row | null, place: number, size: number): Row {
    const level = (parent?.level ?? 0) + 1;
    const isOpening = node.kind !== 'object';
    const name = element('span', { class: 'tree-name', dir: 'auto' }, labelOf(node));
    const twist = element('span', { class: 'tree-twist', 'aria-hidden': 'true' }, isOpening ? icon(ICONS.next) : null);
    const eye = node.kind === 'group' ? null : element('span', { class: 'tree-eye', 'aria-hidden': 'true' });
    const count = isOpening ? element('span', { class: 'tree-count' }, formatCount(node.end - node.begin)) : null;
    const root = element('div', {
      class: 'tree-row', role: 'treeitem', tabindex: '-1', 'aria-level': String(level), 'aria-posinset': String(place), 'aria-setsize': String(size),
      'aria-expanded': isOpening ? 'false' : null, 'aria-selected': 'false',
    }, twist, name, count, eye);
    root.style.setProperty('--level', String(level - 1));
    const row: Row = { node, level, parent, root, children: null };
    this.showState(row);
    return row;
  }

  private showState({ node, root }: Row): void {
    if (node.kind !== 'group') root.setAttribute('aria-checked', CHECKED[this.acts.visibility(node.text)]);
  }

  private async expand(row: Row): Promise<void> {
    if (row.children !== null || row.node.kind === 'object') return;
    row.root.setAttribute('aria-busy', 'true');
    const { table } = this;
    const children = await this.read(row.node, row);
    row.root.removeAttribute('aria-busy');
    if (children === null || row.children !== null || table !== this.table || !row.root.isConnected) return;
    row.children = children;
    row.root.setAttribute('aria-expanded', 'true');
    row.root.after(...children.map(({ root }) => root));
    if (children.length === 1 && row.level < MOST_OPENED) await this.expand(children[0]);
  }

  private collapse(row: Row): void {
    for (const below of this.all(row.children ?? [])) {
      if (below === this.active) this.activate(row);
      below.root.remove();
    }
    row.children = null;
    row.root.setAttribute('aria-expanded', 'false');
  }

  private turn(row: Row): void {
    if (row.children === null) void this.expand(row);
    else this.collapse(row);
  }

  /// As they are seen.
  private *all(rows: readonly Row[]): Generator<Row> {
    const left = [...rows].reverse();
    for (let row = left.pop(); row !== undefined; row = left.pop()) {
      yield row;
      left.push(...[...(row.children ?? [])].reverse());
    }
  }

  private activate(row: Row | undefined, takesFocus = true): void {
    if (row === undefined) return;
    this.active?.root.setAttribute('aria-selected', 'false');
    if (this.active !== null) this.active.root.tabIndex = -1;
    this.active = row;
    row.root.tabIndex = 0;
    row.root.setAttribute('aria-selected', 'true');
    row.root.scrollIntoView({ block: 'nearest' });
    if (takesFocus) row.root.focus();
    this.showActs();
  }

  private showActs(): void {
    const node = this.active?.node ?? null;
    const isGroup = node === null || node.kind === 'group';
    this.only.disabled = this.show.disabled = isGroup;
    this.fly.disabled = node === null;
    this.show.textContent = node === null || isGroup || this.acts.visibility(node.text) === 'shown' ? words.objects.hide : words.objects.show;
  }

  private toggleShown(): void {
    const node = this.active?.node;
    if (node !== undefined && node.kind !== 'group') this.acts.show(node.text, this.acts.visibility(node.text) !== 'shown');
  }

  private rowAt(target: Element): Row | undefined {
    const at = target.closest('[role=treeitem]');
    return [...this.all(this.rows)].find(({ root }) => root === at);
  }

  private clicked(target: Element): void {
    const row = this.rowAt(target);
    if (row === undefined) return;
    this.activate(row);
    if (target.closest('.tree-eye') !== null) this.toggleShown();
    else if (row.node.kind === 'object') this.acts.pick(row.node.begin);
    else this.turn(row);
  }

  private keyed(event: KeyboardEvent): void {
    const { active } = this;
    if (active === null || event.ctrlKey || event.altKey || event.metaKey) return;
    const isTaken = this.move(active, event.key) || this.act(active, event.key) || (event.key.length === 1 && this.jump(active, event.key, event.timeStamp));
    if (!isTaken) return;
    event.preventDefault();
    event.stopPropagation();
  }

  private move(active: Row, key: string): boolean {
    const rows = [...this.all(this.rows)];
    const at = rows.indexOf(active);
    const to: Readonly<Record<string, number>> = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: rows.length - 1 };
    if (!Object.hasOwn(to, key)) return false;
    this.activate(rows.at(Math.max(to[key], 0)));
    return true;
  }

  private act(active: Row, key: string): boolean {
    const isOpen = active.children !== null;
    if (key === 'ArrowRight' && isOpen) this.activate(active.children![0]);
    else if (key === 'ArrowRight') void this.expand(active);
    else if (key === 'ArrowLeft' && isOpen) this.collapse(active);
    else if (key === 'ArrowLeft') this.activate(active.parent ?? active);
    else if (key === ' ') this.toggleShown();
    else if (key === 'Enter' && active.node.kind !== 'object') this.turn(active);
    else if (key === 'Enter') this.take(active.node);
    else return false;
    return true;
  }

  private take(node: ObjectNode): void {
    this.acts.pick(node.begin);
    this.acts.fly(node);
  }

  /// To the next row that begins with what was typed.
  private jump(active: Row, key: string, now: number): boolean {
    const isNew = now - this.typed.at > TYPED_TOGETHER;
    this.typed = { text: (isNew ? '' : this.typed.text) + key.toLowerCase(), at: now };
    const rows = [...this.all(this.rows)];
    const at = rows.indexOf(active) + (isNew ? 1 : 0);
    const after = [...rows.slice(at), ...rows.slice(0, at)];
    this.activate(after.find(({ node }) => labelOf(node).toLowerCase().startsWith(this.typed.text)));
    return true;
  }
}
