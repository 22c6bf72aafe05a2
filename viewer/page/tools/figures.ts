// SPDX-License-Identifier: MIT
// A list of names and values in a card.
import { element } from '../parts/element.js';

export function figures(rows: readonly (readonly [name: string, value: string])[]): HTMLElement[] {
  return rows.map(([name, value]) => element('div', {}, element('dt', {}, name), element('dd', {}, value)));
}

/// Told to those who hear the page when it changes.
export function figureList(): HTMLElement {
  return element('dl', { class: 'figures tool-figures', 'aria-live': 'polite' });
}

export function textButton(name: string, act: () => void): HTMLButtonElement {
  const button = element('button', { type: 'button', class: 'text-button' }, name);
  button.addEventListener('click', act);
  return button;
}
