// SPDX-License-Identifier: MIT
// Objects whose names fit what was typed: those that begin so, and of tables that are soon read those that have it anywhere.
import type { ObjectRow } from '../hierarchy/object_blocks.js';
import type { ObjectTable } from '../hierarchy/object_table.js';

/// Tables of so many objects are read whole: 64 blocks, about a MB.
const MOST_READ = 2 ** 14;

function capital(word: string): string {
  return word.slice(0, 1).toUpperCase() + word.slice(1);
}

/// A text as it was typed, and as names are often written.
function waysOf(text: string): Iterable<string> {
  return new Set([text, capital(text), text.replace(/[^\s/_.-]+/g, capital), text.toLowerCase(), text.toUpperCase()]);
}

/// The first `most` of the names that begin with a text, however its letters are written, then of those that have all of its words. An object
/// without a name fits nothing. Rejects as the table does.
export async function fittingNames(table: ObjectTable, text: string, most: number): Promise<ObjectRow[]> {
  const found = new Map<number, ObjectRow>();
  const words = text.toLowerCase().split(/\s+/).filter((word) => word !== '');
  if (words.length === 0) return [];
  for (const way of waysOf(text.trimStart())) for (const row of await table.startingWith(way, most)) found.set(row.object, row);
  if (found.size < most && table.count <= MOST_READ) {
    const fits = ({ name }: ObjectRow): boolean => words.every((word) => name.toLowerCase().includes(word));
    for (const row of (await table.rows({ begin: 0, end: table.count })).filter(fits)) found.set(row.object, row);
  }
  return [...found.values()].slice(0, most);
}
