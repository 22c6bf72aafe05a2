// SPDX-License-Identifier: MIT
// Tells what hands and keys do, and what the modes are called.
import { element } from '../parts/element.js';
import { words } from '../words/words.js';

function rows(pairs: readonly (readonly string[])[]): HTMLElement {
  return element('dl', { class: 'help' }, ...pairs.map(([what, does]) => element('div', {}, element('dt', {}, what), element('dd', {}, does))));
}

export function help(): HTMLElement {
  const { hands, keys, modesTitle, modes } = words.help;
  return element('div', {}, rows([...hands, ...keys]), element('h3', { class: 'help-title' }, modesTitle), rows(modes));
}
