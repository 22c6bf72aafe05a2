// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { chooseLanguage, LANGUAGES, localeOf } from '../../page/words/languages.js';
import { TOOL_TABLES } from '../../page/tools/words/words.js';
import { TABLES } from '../../page/words/words.js';

/// Every word of a table with its place in it; functions are given their arguments' names, and numbers more than one.
function* entries(table: unknown, place = ''): Generator<[string, string]> {
  if (typeof table === 'string') yield [place, table];
  else if (typeof table === 'function') yield [place, String((table as (...given: unknown[]) => unknown)(...argumentsOf(table)))];
  else for (const [key, value] of Object.entries(table as object)) yield* entries(value, `${place}.${key}`);
}

function argumentsOf(given: object): string[] {
  return Array.from({ length: (given as { length: number }).length }, (_, i) => `<${i}>`);
}

/// Which of a function's arguments a text has; `counted` tells a count by its written form alone.
function argumentsIn(text: string): string[] {
  return (text.match(/<\d>/g) ?? []).sort();
}

const ALL = LANGUAGES.map((language) => [language, new Map(entries({ page: TABLES[language], tools: TOOL_TABLES[language] }))] as const);
const ENGLISH = new Map(ALL).get('en')!;

describe.each(ALL)('the words in %s', (language, table) => {

  it('have the same keys as in English, in lists too', () => {
    expect([...table.keys()].sort()).toEqual([...ENGLISH.keys()].sort());
  });

  it('say something, and what they are given', () => {
    for (const [place, text] of table) {
      expect(text.trim(), place).not.toBe('');
      expect(argumentsIn(text), place).toEqual(argumentsIn(ENGLISH.get(place)!));
    }
  });

  it('are its own', () => {
    const alike = [...table].filter(([place, text]) => text.length > 12 && text === ENGLISH.get(place));
    expect(language === 'en' || alike.length < 5, JSON.stringify(alike)).toBe(true);
  });

  it('tell one from many', () => {
    const { counts } = TABLES[language];
    for (const name of Object.keys(counts) as (keyof typeof counts)[]) expect(counts[name](1, 'x')).not.toBe(counts[name](2, 'x'));
  });
});

describe('the language', () => {
  it.each([
    ['?lang=de', 'es', ['en'], 'de'],
    ['?lang=tlh', 'es', ['en'], 'es'],
    ['', null, ['fr-FR', 'es-MX', 'en'], 'es'],
    ['', null, ['DE-ch'], 'de'],
    ['?model=x', null, [], 'en'],
  ] as const)('of %s, chosen %s, wanted %j, is %s', (search, chosen, wanted, language) => {
    expect(chooseLanguage(search, chosen, wanted)).toBe(language);
  });

  it("is written in the visitor's own form", () => {
    expect(localeOf('de', ['en-GB', 'de-CH'])).toBe('de-CH');
    expect(localeOf('es', ['en-GB'])).toBe('es');
  });
});
