// SPDX-License-Identifier: MIT
// Makes tables of words for tests, as docs/file_format.md says (section 9.1).
import { compareBytes } from '../../src/hierarchy/byte_columns.js';
import { LETTER_TABLE } from '../../src/hierarchy/letter_table.js';
import { Letters } from '../../src/hierarchy/letters.js';
import { tableOfRows, type NewRow, type WrittenTable } from './object_table.js';

export const letters = new Letters(LETTER_TABLE, (what) => { throw new Error(what); });

export function plainRow(name: string, values: NewRow['values'] = []): NewRow {
  return { name, values, box: null, triangles: 0, area: 0 };
}

function numberText(number: number): string {
  return number < 64 ? String.fromCharCode(number) : String.fromCharCode(64 + (number % 64)) + numberText(Math.floor(number / 64));
}

/// Of a word, or of a part of its objects.
export function wordRow(word: string, objects: readonly number[]): NewRow {
  const text = objects.slice(1).map((object, i) => numberText(object - objects[i] - 1)).join('');
  return plainRow(`${word} ${objects[0].toString(16).padStart(6, '0')}`, [text]);
}

/// `rows`: ascending, behind the table of letters.
export function tableOfWordRows(rows: readonly NewRow[], table = LETTER_TABLE): WrittenTable {
  const { bytes, json } = tableOfRows([plainRow('', [table]), ...rows], [{ name: 'objects', type: 'text' }]);
  return { bytes, json: { ...json, file: 'object_words.bin' } };
}

export function byBytes(a: string, b: string): number {
  return compareBytes(Buffer.from(a), Buffer.from(b));
}

/// `names`: ascending by their bytes.
export function tableOfWords(names: readonly string[]): WrittenTable {
  const objects = new Map<string, number[]>();
  names.forEach((name, i) => { for (const word of new Set(letters.words(name))) objects.set(word, [...(objects.get(word) ?? []), i]); });
  return tableOfWordRows([...objects].flatMap(([word, all]) => Array.from({ length: Math.ceil(all.length / 4096) }, (_, i) => wordRow(word, all.slice(4096 * i, 4096 * (i + 1))))).sort((a, b) => byBytes(a.name, b.name)));
}
