// SPDX-License-Identifier: MIT
// Two models of the gallery that are chosen to be compared.
import { compareAddress } from '../pair/compare_address.js';
import type { Model } from '../listing.js';
import { element, iconButton } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { words } from '../words/words.js';

const text = words.pair.gallery;

export class Comparison {
  /// Tells what is chosen, and leads on.
  readonly root = element('div', { class: 'gallery-compare', role: 'status', hidden: true });
  private chosen: readonly Model[] = [];
  private readonly buttons = new Map<string, HTMLButtonElement>();

  /// A button that chooses a model, or does so no longer.
  button(model: Model): HTMLButtonElement {
    const button = iconButton(text.choose(model.name), ICONS.compare, () => { this.toggle(model); });
    button.classList.add('cell-compare');
    this.buttons.set(model.path, button);
    this.press(model);
    return button;
  }

  /// The cell is no longer there.
  forget({ path }: Model): void {
    this.buttons.delete(path);
  }

  private isChosen({ path }: Model): boolean {
    return this.chosen.some((each) => each.path === path);
  }

  private press(model: Model): void {
    this.buttons.get(model.path)?.setAttribute('aria-pressed', String(this.isChosen(model)));
  }

  /// A third choice replaces the first one.
  private toggle(model: Model): void {
    const others = this.chosen.filter(({ path }) => path !== model.path);
    const before = this.chosen;
    this.chosen = this.isChosen(model) ? others : [...others.slice(-1), model];
    for (const each of [...before, model]) this.press(each);
    this.show();
  }

  private show(): void {
    const [first, second] = this.chosen;
    this.root.hidden = this.chosen.length === 0;
    if (this.root.hidden) return;
    const none = iconButton(text.none, ICONS.close, () => { for (const each of this.chosen) this.toggle(each); });
    const address = second === undefined ? null : compareAddress(location.href, { url: first.url, other: second.url, story: first.story, pose: null, choices: '' });
    const said = address === null ? element('span', {}, text.one(first.name)) : element('a', { class: 'text-button', href: address }, text.go(first.name, second.name));
    this.root.replaceChildren(said, none);
  }
}
