// SPDX-License-Identifier: MIT
// Finds and orders models.
import { element } from '../parts/element.js';
import { words } from '../words/words.js';
import type { TagCount } from '../listing.js';
import { formatCount } from '../numbers.js';
import { ORDERS, type Order } from '../preferences.js';
import type { Wish } from './wish.js';

const PAUSE = 120; // milliseconds without a key before a search

export class Toolbar {
  readonly root: HTMLElement;
  private readonly search = element('input', { type: 'search', class: 'field search', 'aria-label': words.gallery.search, placeholder: words.gallery.search, autocomplete: 'off', spellcheck: 'false' });
  private readonly order: HTMLSelectElement;
  private readonly tag = element('select', { class: 'field', 'aria-label': words.gallery.tag, hidden: true });
  private readonly map = element('button', { type: 'button', class: 'field map-button', 'aria-pressed': 'false', hidden: true }, words.gallery.map);
  private timer = 0;
  private current: Wish;

  /// `wished`: another search, or another order. `mapped`: the map is wanted, or not any more.
  constructor(order: Order, wished: () => void, mapped: (on: boolean) => void) {
    const options = ORDERS.map((one) => element('option', { value: one, selected: one === order }, words.gallery.orders[one]));
    this.order = element('select', { class: 'field', 'aria-label': words.gallery.order }, ...options);
    this.root = element('search', { class: 'toolbar' }, this.search, this.tag, this.order, this.map);
    this.current = this.read();
    const changed = (): void => {
      window.clearTimeout(this.timer);
      this.current = this.read();
      wished();
    };
    for (const select of [this.order, this.tag]) select.addEventListener('change', changed);
    this.map.addEventListener('click', () => {
      const on = this.map.getAttribute('aria-pressed') !== 'true';
      this.map.setAttribute('aria-pressed', String(on));
      mapped(on);
    });
    this.search.addEventListener('input', () => {
      window.clearTimeout(this.timer);
      this.timer = window.setTimeout(changed, PAUSE);
    });
  }

  focus(): void {
    this.search.focus();
    this.search.select();
  }

  /// Offers the tags that models have, and a map if any has a place. The chosen tag stays.
  offer(tags: readonly TagCount[], placed: number): void {
    const { value } = this.tag;
    const known = tags.some(({ tag }) => tag === value) || value === '' ? tags : [{ tag: value, count: 0 }, ...tags];
    this.tag.hidden = known.length === 0;
    this.tag.replaceChildren(element('option', { value: '' }, words.gallery.anyTag), ...known.map(({ tag, count }) => element('option', { value: tag }, `${tag} (${formatCount(count)})`)));
    this.tag.value = value;
    this.map.hidden = placed === 0 && this.map.getAttribute('aria-pressed') !== 'true';
  }

  /// As it was told last.
  get wish(): Wish {
    return this.current;
  }

  private read(): Wish {
    return { search: this.search.value.trim(), tag: this.tag.value, order: ORDERS[this.order.selectedIndex] };
  }
}
