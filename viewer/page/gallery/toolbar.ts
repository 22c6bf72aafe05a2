// SPDX-License-Identifier: MIT
// Finds and orders models.
import { element } from '../parts/element.js';
import { words } from '../words/words.js';
import type { Wish } from './arrangement.js';
import { ORDERS, type Order } from '../preferences.js';

const PAUSE = 120; // milliseconds without a key before a search

export class Toolbar {
  readonly root: HTMLElement;
  private readonly search = element('input', { type: 'search', class: 'field search', 'aria-label': words.gallery.search, placeholder: words.gallery.search, autocomplete: 'off', spellcheck: 'false' });
  private readonly order: HTMLSelectElement;
  private timer = 0;

  /// `wished`: another search, or another order.
  constructor(order: Order, wished: () => void) {
    const options = ORDERS.map((one) => element('option', { value: one, selected: one === order }, words.gallery.orders[one]));
    this.order = element('select', { class: 'field', 'aria-label': words.gallery.order }, ...options);
    this.root = element('search', { class: 'toolbar' }, this.search, this.order);
    this.order.addEventListener('change', wished);
    this.search.addEventListener('input', () => {
      window.clearTimeout(this.timer);
      this.timer = window.setTimeout(wished, PAUSE);
    });
  }

  get wish(): Wish {
    return { search: this.search.value.trim(), order: ORDERS[this.order.selectedIndex] };
  }
}
