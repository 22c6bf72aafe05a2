// SPDX-License-Identifier: MIT
// Chooses a model to compare with: one of the listing, or any by its address.
import { modelOfPath, type Model } from '../listing.js';
import { element } from '../parts/element.js';
import { words } from '../words/words.js';
import type { PageContext } from '../view/page_context.js';

const MOST_SHOWN = 40;

function fits({ name, path }: Model, asked: string): boolean {
  const text = `${name} ${path}`.toLowerCase();
  return asked.toLowerCase().split(/\s+/).every((word) => text.includes(word));
}

export class CompareForm {
  readonly root: HTMLElement;
  private readonly field = element('input', { type: 'search', class: 'field', 'aria-label': words.pair.search, placeholder: words.pair.search, autocomplete: 'off', spellcheck: 'false' });
  private readonly list = element('ul', { class: 'compare-list' });
  private readonly note = element('p', { class: 'hint', role: 'status' });
  private models: readonly Model[] = [];

  /// `chosen`: told the address of the other hierarchy.
  constructor(context: PageContext, private readonly chosen: (url: string) => void) {
    const form = element('form', {}, this.field);
    this.field.addEventListener('input', () => { this.show(); });
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.take();
    });
    this.root = element('div', {}, element('p', { class: 'hint' }, words.pair.choose(context.model.name)), form, this.list, this.note);
    context.arrival.findModels(context.signal).then((models) => {
      this.models = models.filter(({ url }) => url !== context.model.url);
      this.show();
    }, () => undefined); // an address does without a listing
  }

  /// What is typed is a model of the list, or an address.
  private take(): void {
    const asked = this.field.value.trim();
    const named = this.models.find(({ name, path }) => name === asked || path === asked);
    const model = named ?? modelOfPath(asked, document.baseURI);
    if (model !== null) this.chosen(model.url);
    else if (asked !== '') this.note.textContent = words.problems.badAddress(asked.slice(0, 200));
  }

  private show(): void {
    const asked = this.field.value.trim();
    const fitting = this.models.filter((model) => asked === '' || fits(model, asked));
    this.note.textContent = fitting.length > MOST_SHOWN ? words.pair.more : '';
    this.list.replaceChildren(...fitting.slice(0, MOST_SHOWN).map((model) => {
      const button = element('button', { type: 'button', class: 'text-button', title: model.path }, model.name);
      button.addEventListener('click', () => { this.chosen(model.url); });
      return element('li', {}, button);
    }));
  }
}
