// SPDX-License-Identifier: MIT
// Chooses the page's language. Each one calls itself what its speakers call it.
import type { Page } from '../page.js';
import { LANGUAGES } from '../words/languages.js';
import { language, TABLES, words } from '../words/words.js';
import { element } from './element.js';

export function languageSelect(page: Page): HTMLSelectElement {
  const options = LANGUAGES.map((tag) => element('option', { value: tag, lang: tag, selected: tag === language }, TABLES[tag].language));
  const select = element('select', { class: 'language', 'aria-label': words.parts.language }, ...options);
  select.addEventListener('change', () => { page.setLanguage(LANGUAGES[select.selectedIndex]); });
  return select;
}
