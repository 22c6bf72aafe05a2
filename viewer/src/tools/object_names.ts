// SPDX-License-Identifier: MIT
// Objects whose names fit what was typed: those that begin so, then those that have all of its words, the last one perhaps its beginning.
//
// A table of words tells which objects have a word. The rarest word's are read first, then those of the others, and what is common to all is
// found. A word of very many objects, as the first letter of one, is looked for in the names themselves: many have it, so a few are enough.
import { fits, Letters, type AskedWord } from '../hierarchy/letters.js';
import type { ObjectRow } from '../hierarchy/object_blocks.js';
import type { ObjectRange, ObjectTable } from '../hierarchy/object_table.js';
import { ObjectWords } from '../hierarchy/object_words.js';

/// Tables without words are read whole if they have no more objects: 64 blocks, about a MB.
const MOST_READ = 2 ** 14;
/// Blocks of the table of words that are read for one question, of about 5 kB each.
const MOST_WORD_BLOCKS = 32;
/// Blocks of names that are, of about 10 kB each.
const MOST_NAME_BLOCKS = 32;
/// So many blocks of names are read at once.
const AT_ONCE = 4;
/// Words that are looked for in the table; further ones are in the names.
const MOST_WORDS = 32;

export interface FoundNames {
  readonly rows: readonly ObjectRow[];
  /// There may be others.
  readonly hasMore: boolean;
}

function capital(word: string): string {
  return word.slice(0, 1).toUpperCase() + word.slice(1);
}

/// A text as it was typed, and as names are often written.
function waysOf(text: string): string[] {
  return [...new Set([text, capital(text), text.replace(/[^\s/_.-]+/g, capital), text.toLowerCase(), text.toUpperCase()])];
}

/// A text in letters that have no case and no accents, by this browser's Unicode.
function plain(text: string): string {
  return text.normalize('NFKD').replace(/\p{Mn}/gu, '').toUpperCase().toLowerCase();
}

/// What is left of all objects.
interface Candidates {
  /// Counts for each object how many of the words it has: a candidate has all that were looked for.
  readonly levels: Uint8Array;
  readonly level: number;
  /// Words that were not looked for yet.
  readonly left: readonly AskedWord[];
}

/// The first candidate from `object` on; -1: there is none.
function nextOf({ levels, level }: Candidates, object: number): number {
  return levels.indexOf(level, object);
}

/// Null: there are none.
async function candidatesOf(words: ObjectWords, asked: readonly AskedWord[], signal?: AbortSignal): Promise<Candidates | null> {
  const places = await Promise.all(asked.slice(0, MOST_WORDS).map((word) => words.place(word)));
  places.sort((a, b) => a.ranges.length - b.ranges.length);
  signal?.throwIfAborted();
  const levels = new Uint8Array(words.count);
  const left = asked.slice(MOST_WORDS);
  let [room, level] = [MOST_WORD_BLOCKS, 0];
  for (const place of places) {
    room -= place.ranges.length;
    if (room < 0) left.push(place.asked);
    else if (!(await words.raise(place, levels, level++, signal))) return null;
  }
  return { levels, level, left };
}

/// The first of the candidates whose names have the words that are left.
async function walk(table: ObjectTable, words: ObjectWords, candidates: Candidates, most: number, signal?: AbortSignal): Promise<FoundNames> {
  const letters = await words.letters();
  let next = nextOf(candidates, 0);
  const holding = (await table.blocksOf({ begin: 0, end: table.count })).filter(({ begin, end }: ObjectRange) => {
    if (next >= 0 && next < begin) next = nextOf(candidates, begin);
    return next >= 0 && next < end;
  });
  const rows: ObjectRow[] = [];
  let read = 0;
  for (; read < Math.min(holding.length, MOST_NAME_BLOCKS) && rows.length <= most; read += AT_ONCE) {
    const part = (await Promise.all(holding.slice(read, read + AT_ONCE).map((range) => table.rows(range)))).flat();
    signal?.throwIfAborted();
    rows.push(...part.filter(({ object, name }) => candidates.levels[object] === candidates.level && fits(letters.words(name), candidates.left)));
  }
  return { rows: rows.slice(0, most), hasMore: read < holding.length || rows.length > most };
}

async function withWords(table: ObjectTable, words: ObjectWords, text: string, most: number, signal?: AbortSignal): Promise<FoundNames> {
  const asked = (await words.letters()).asked(text);
  signal?.throwIfAborted();
  const candidates = asked.length === 0 ? null : await candidatesOf(words, asked, signal);
  if (candidates === null) return { rows: [], hasMore: false };
  if (candidates.left.length > 0) return walk(table, words, candidates, most, signal);
  const objects: number[] = [];
  for (let next = nextOf(candidates, 0); next >= 0 && objects.length <= most; next = nextOf(candidates, next + 1)) objects.push(next);
  return { rows: await Promise.all(objects.slice(0, most).map((object) => table.row(object))), hasMore: objects.length > most };
}

let known: Letters | null = null;

/// The letters of tables that have no words.
async function lettersOfAll(): Promise<Letters> {
  if (known !== null) return known;
  const { LETTER_TABLE } = await import('../hierarchy/letter_table.js');
  return (known = new Letters(LETTER_TABLE, (what) => { throw new Error(what); }));
}

/// Finds what a table of words would, and names that have the parts of the text anywhere.
async function withoutWords(table: ObjectTable, text: string, most: number): Promise<FoundNames> {
  if (table.count > MOST_READ) return { rows: [], hasMore: false };
  const letters = await lettersOfAll();
  const asked = letters.asked(text);
  const parts = plain(text).split(/\s+/).filter((part) => part !== '');
  const hasWords = (name: string): boolean => asked.length > 0 && fits(letters.words(name), asked);
  const rows = (await table.rows({ begin: 0, end: table.count })).filter(({ name }) => parts.every((part) => plain(name).includes(part)) || hasWords(name));
  return { rows, hasMore: rows.length > most };
}

/// The first `most` of the names that begin with a text, however its letters are written, then of those that have all of its words. An object
/// without a name fits nothing. Rejects as the table does, or as `signal` is aborted.
export async function fittingNames(table: ObjectTable, text: string, most: number, signal?: AbortSignal): Promise<FoundNames> {
  if (text.trim() === '') return { rows: [], hasMore: false };
  const begin = (await Promise.all(waysOf(text.trimStart()).map((way) => table.startingWith(way, most)))).flat();
  signal?.throwIfAborted();
  const found = new Map(begin.map((row) => [row.object, row]));
  // Those that begin so may be all of the first ones.
  const words = ObjectWords.of(table);
  const all = found.size < most ? await (words === null ? withoutWords(table, text, most) : withWords(table, words, text, most, signal)) : { rows: [], hasMore: true };
  for (const row of all.rows) found.set(row.object, row);
  return { rows: [...found.values()].slice(0, most), hasMore: all.hasMore || found.size > most };
}
