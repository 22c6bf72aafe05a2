// SPDX-License-Identifier: MIT
// A list of texts that can be changed, gone to and removed.
import { element, iconButton } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { TOOL_ICONS } from './icons.js';
import { words } from './words/words.js';

export interface Entry {
  readonly text: string;
  rename(text: string): void;
  go(): void;
  remove(): void;
}

const MOST_LETTERS = 500;

function row(entry: Entry, name: string): HTMLElement {
  const input = element('input', { type: 'text', class: 'tool-text', 'aria-label': name, maxlength: String(MOST_LETTERS) });
  input.value = entry.text;
  input.addEventListener('change', () => { entry.rename(input.value); });
  return element('li', {}, input, iconButton(words.list.go(name), TOOL_ICONS.go, () => { entry.go(); }), iconButton(words.list.remove(name), ICONS.close, () => { entry.remove(); }));
}

/// `what`: one of them is called, with its number.
export function entryList(entries: readonly Entry[], what: (number: string) => string): HTMLElement[] {
  return entries.map((entry, i) => row(entry, what(String(i + 1))));
}
