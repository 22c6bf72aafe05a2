// SPDX-License-Identifier: MIT
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { JsonValue } from '../../src/json_value.js';
import { LETTER_TABLE } from '../../src/hierarchy/letter_table.js';
import { fits, Letters } from '../../src/hierarchy/letters.js';
import { readObjectFacts, type TableFacts } from '../../src/hierarchy/object_facts.js';
import { ObjectTable } from '../../src/hierarchy/object_table.js';
import { HierarchyProblem } from '../../src/hierarchy/problem.js';
import { fittingNames } from '../../src/tools/object_names.js';
import { tableOfRows, type WrittenTable } from '../support/object_table.js';
import { byBytes, letters, plainRow, tableOfWordRows, tableOfWords, wordRow } from '../support/object_words.js';

/// A host that counts the bytes it is asked for. `words`: null: there is no table of them.
function opened(names: readonly string[], words: WrittenTable | null): { table: ObjectTable; read: () => number } {
  let read = 0;
  const objects = tableOfRows(names.map((name) => plainRow(name)), []);
  const facts = readObjectFacts(JsonValue.parse(JSON.stringify(words === null ? objects.json : { ...objects.json, words: words.json }), (what) => { throw new Error(what); }));
  const open = (of: TableFacts, bytes: Uint8Array<ArrayBuffer>, own: ObjectTable | null = null): ObjectTable => new ObjectTable(of, (first, end) => {
    read += end - first;
    return Promise.resolve(bytes.slice(first, end));
  }, own);
  return { table: open(facts, objects.bytes, facts.words && words && open(facts.words, words.bytes)), read: () => read };
}

async function found(table: ObjectTable, text: string, most = 8): Promise<string[]> {
  return (await fittingNames(table, text, most)).rows.map(({ name }) => name);
}

/// What all programs make of names and of texts that are looked for.
const FOLDED = JSON.parse(readFileSync(new URL('../../../tests/data/folded_words.json', import.meta.url), 'utf8')) as {
  readonly names: readonly { readonly name: string; readonly words: readonly string[] }[];
  readonly texts: readonly { readonly text: string; readonly asked: readonly { readonly word: string; readonly is_beginning: boolean }[] }[];
};

describe('letters', () => {
  it('of the program are those of hierarchies of few objects', () => {
    const source = readFileSync(new URL('../../../storage/format/letter_table.cpp', import.meta.url), 'utf8');
    expect([...source.matchAll(/^ {4}"(.*)";?$/gm)].map(([, line]) => line.replaceAll('\\n', '\n')).join('')).toBe(LETTER_TABLE);
  });

  it.each(FOLDED.names)('of "$name" are its words', ({ name, words }) => { expect(letters.words(name)).toEqual(words); });

  it.each(FOLDED.texts)('of "$text" are what it looks for', ({ text, asked }) => {
    expect(letters.asked(text)).toEqual(asked.map(({ word, is_beginning: isBeginning }) => ({ word, isBeginning })));
  });

  it('are folded as people type them', () => {
    expect(letters.words('bldg_0042 Church of St. Mary')).toEqual(['bldg', '0042', 'church', 'of', 'st', 'mary']);
    expect(letters.words('STRASSE Straße Église E\u0301glise Łódź ＡＢ ﬁn')).toEqual(['strasse', 'strasse', 'eglise', 'eglise', 'lodz', 'ab', 'fin']);
    expect(letters.words('서울')).toEqual(['\u1109\u1165\u110b\u116e\u11af']);
    expect(letters.words('東京タワー2')).toEqual(['東京', '京タ', 'タワ', 'ワー', 'ー', '2']);
    expect(letters.asked('京 church mar')).toEqual([{ word: '京', isBeginning: true }, { word: 'church', isBeginning: false }, { word: 'mar', isBeginning: true }]);
    expect(letters.words('a'.repeat(40))).toEqual(['a'.repeat(32)]);
    expect(letters.words(' -./ ')).toEqual([]);
  });

  it.each(['41 1a 1 1 61', '41 1a 1\n', 'x\n', '41 1a 1 1 61 62\n', '41 0 1 0\n', '41 1 0 0\n', '110000 1 1 0\n', '41 ffffffff 1 0\n', '41 1 1 3\n', '41 2 1 1 10ffff\n', '61 1 1 0\n41 1 1 0\n', '\n'])('of a wrong table %j are refused', (text) => {
    expect(() => new Letters(text, (what) => { throw new HierarchyProblem('w', what); })).toThrow(HierarchyProblem);
  });
});

describe('names', () => {
  const names = FOLDED.names.map(({ name }) => name).sort(byBytes);
  const few = opened(names, null).table;
  const indexed = opened(names, tableOfWords(names)).table;

  it.each(FOLDED.texts.map(({ text }) => text))('are found by the words of "%s", with a table of words or without', async (text) => {
    const asked = letters.asked(text);
    const expected = asked.length === 0 ? [] : names.filter((name) => fits(letters.words(name), asked));
    for (const table of [few, indexed]) expect(await found(table, text, 99)).toEqual(expect.arrayContaining(expected));
  });

  it('that are few are found by what stands within their words, too', async () => {
    expect(await found(few, 'urch')).toEqual(['bldg_0042 Church of St. Mary']);
    expect(await found(indexed, 'urch')).toEqual([]);
  });
});

describe('words of names', () => {
  const streets = ['Main', 'Église', 'Straße', 'Öst', '東京', 'улица'];
  const names = ['', ...Array.from({ length: 9000 }, (_, i) => `bldg_${String((i * 7919) % 9000).padStart(5, '0')} ${streets[i % 6]} ${i % 11 === 0 ? 'Church' : 'House'} ${i % 37}`)].sort(byBytes);
  const { table, read } = opened(names, tableOfWords(names));

  it.each(['church', 'church mai', 'MAIN church', 'eglise 7 house', 'strasse', 'h', 'house', '36 ulica', '36 улица', '東京 church 1', 'zzz', 'main zzz', 'main strasse', '  '])('%j find what a search of all names finds', async (text) => {
    const asked = letters.asked(text);
    const expected = asked.length === 0 ? [] : names.filter((name) => fits(letters.words(name), asked));
    const { rows, hasMore } = await fittingNames(table, text, 8);
    expect(rows.map(({ name }) => name)).toEqual(expected.slice(0, 8));
    expect(hasMore).toBe(expected.length > 8);
  });

  it('begin so before those that have it elsewhere', async () => {
    expect(await found(table, 'bldg_00017')).toHaveLength(1);
    expect(await found(opened(['a church', 'church b', 'the church'], tableOfWords(['a church', 'church b', 'the church'])).table, 'church')).toEqual(['church b', 'a church', 'the church']);
  });

  it('need a few blocks', async () => {
    const other = opened(names, tableOfWords(names));
    await found(other.table, 'church');
    const before = other.read();
    await found(other.table, 'strasse church 7');
    expect(other.read() - before).toBeLessThan(60_000);
    expect(read()).toBeGreaterThan(0);
  });

  it('of very many objects are looked for in their names', async () => {
    const many = Array.from({ length: 9000 }, (_, i) => `n${String(i).padStart(5, '0')} ${String.fromCharCode(97 + (i % 26))}${i} ${i % 500 === 499 ? 'rare' : 'usual'}`).sort(byBytes);
    const { table: other } = opened(many, tableOfWords(many));
    const { rows, hasMore } = await fittingNames(other, 'rare n', 5);
    expect(rows.map(({ name }) => name)).toEqual(many.filter((name) => name.endsWith('rare')).slice(0, 5));
    expect(hasMore).toBe(true);
    expect((await fittingNames(other, 'zzz n', 5)).hasMore).toBe(false);
  });

  it('are not looked for any more when another text is typed', async () => {
    const asking = new AbortController();
    const search = fittingNames(table, 'church main', 8, asking.signal);
    asking.abort();
    await expect(search).rejects.toThrow(/abort/i);
  });

  it.each([
    ['an object that there is not', [wordRow('word', [0, 3])]],
    ['no first object', [plainRow('word', [null])]],
    ['a number that does not end', [plainRow('word 000000', ['A'])]],
    ['a number that is none', [plainRow('word 000000', ['\u00e9'])]],
    ['too many objects', [plainRow('word 000000', ['\0'.repeat(5000)])]],
  ])('with %s are refused', async (_, rows) => {
    const { table: other } = opened(['a', 'b', 'c'], tableOfWordRows(rows));
    await expect(fittingNames(other, 'word', 8)).rejects.toThrow(HierarchyProblem);
  });

  it('without a table of letters are refused', async () => {
    await expect(fittingNames(opened(['a'], tableOfWordRows([], 'x')).table, 'word', 8)).rejects.toThrow(/object_words.bin/);
  });
});
