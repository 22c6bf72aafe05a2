// SPDX-License-Identifier: MIT
// A field that finds objects by their names, with suggestions as one types: a combobox with a list, by hand and by key.
import type { ObjectRow } from '../../src/hierarchy/object_blocks.js';
import type { FoundNames } from '../../src/tools/object_names.js';
import { element } from '../parts/element.js';
import { words } from './words/words.js';

const MOST = 8;
const NONE = -1;

/// Names that fit; called for each text that is typed. The signal says that another one was typed meanwhile.
export type Suggest = (text: string, most: number, signal: AbortSignal) => Promise<FoundNames>;

export class ObjectSearch {
  readonly root: HTMLElement;
  private readonly input = element('input', {
    type: 'search', class: 'object-search', role: 'combobox', 'aria-autocomplete': 'list', 'aria-expanded': 'false', 'aria-controls': 'object-suggestions', 'aria-label': words.objects.search, placeholder: words.objects.search, autocomplete: 'off', spellcheck: 'false',
  });
  private readonly list = element('ul', { class: 'object-suggestions', role: 'listbox', id: 'object-suggestions', 'aria-label': words.objects.suggestions, hidden: true });
  private readonly told = element('p', { class: 'tool-note', role: 'status' });
  private rows: readonly ObjectRow[] = [];
  private active = NONE;
  private asking = new AbortController();

  constructor(private readonly suggest: Suggest, private readonly chosen: (row: ObjectRow) => void) {
    this.input.addEventListener('input', () => void this.look());
    this.input.addEventListener('keydown', (event) => { this.keyed(event); });
    this.input.addEventListener('blur', () => { window.setTimeout(() => { this.show([]); }, 200); }); // a tap on the list comes first
    this.root = element('div', { class: 'object-finder' }, this.input, this.list, this.told);
  }

  /// Looks for what fits.
  seek(text: string): void {
    this.input.value = text;
    this.input.focus();
    void this.look();
  }

  private async look(): Promise<void> {
    this.asking.abort();
    this.asking = new AbortController();
    const { signal } = this.asking;
    const text = this.input.value;
    const { rows, hasMore } = text === '' ? { rows: [], hasMore: false } : await this.suggest(text, MOST, signal);
    if (signal.aborted) return;
    this.show(rows);
    this.told.textContent = text === '' ? '' : hasMore ? words.objects.more : rows.length === 0 ? words.objects.nothing : '';
  }

  private show(rows: readonly ObjectRow[]): void {
    this.rows = rows;
    this.active = NONE;
    this.list.replaceChildren(...rows.map((row, i) => {
      const option = element('li', { role: 'option', id: `object-suggestion-${i}`, 'aria-selected': 'false' }, row.name);
      option.addEventListener('pointerdown', (event) => { event.preventDefault(); });
      option.addEventListener('click', () => { this.choose(i); });
      return option;
    }));
    this.list.hidden = rows.length === 0;
    this.input.setAttribute('aria-expanded', String(rows.length > 0));
    this.input.removeAttribute('aria-activedescendant');
  }

  private keyed(event: KeyboardEvent): void {
    if (event.isComposing) return;
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step !== undefined && this.rows.length > 0) this.activate((this.active + step + this.rows.length + (this.active === NONE && step < 0 ? 1 : 0)) % this.rows.length);
    else if (event.key === 'Enter' && this.rows.length > 0) this.choose(Math.max(this.active, 0));
    else if (event.key === 'Escape' && this.rows.length > 0) this.show([]);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  private activate(number: number): void {
    this.active = number;
    [...this.list.children].forEach((option, i) => { option.setAttribute('aria-selected', String(i === number)); });
    this.input.setAttribute('aria-activedescendant', `object-suggestion-${number}`);
    this.list.children[number].scrollIntoView({ block: 'nearest' });
  }

  private choose(number: number): void {
    const row = this.rows[number];
    this.asking.abort();
    this.input.value = row.name;
    this.show([]);
    this.told.textContent = '';
    this.chosen(row);
  }
}
