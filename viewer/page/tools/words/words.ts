// SPDX-License-Identifier: MIT
// The tools' words, in the language of the page.
import type { Language } from '../../words/languages.js';
import { language } from '../../words/words.js';
import { de } from './de.js';
import { en, type ToolWords } from './en.js';
import { es } from './es.js';

export const TOOL_TABLES: Readonly<Record<Language, ToolWords>> = { en, de, es };

export const words = TOOL_TABLES[language];
