// SPDX-License-Identifier: MIT
// The page's words, in the visitor's language: a table for each language, all with the keys of the English one.
// The language holds as long as the page: another one is chosen by loading it again.
import { loadPreferences } from '../preferences.js';
import { de } from './de.js';
import { en, type Words } from './en.js';
import { es } from './es.js';
import { chooseLanguage, localeOf, type Language } from './languages.js';

export const TABLES: Readonly<Record<Language, Words>> = { en, de, es };

/// Outside browsers, English.
function here(): { search: string; wanted: readonly string[] } {
  return typeof document === 'undefined' ? { search: '', wanted: [] } : { search: location.search, wanted: navigator.languages };
}

const { search, wanted } = here();

export const language = chooseLanguage(search, loadPreferences().language, wanted);
export const locale = localeOf(language, wanted);
export const words = TABLES[language];
