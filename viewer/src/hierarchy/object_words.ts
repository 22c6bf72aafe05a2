// SPDX-License-Identifier: MIT
// Which objects have a word in their names, object_words.bin (docs/file_format.md, section 9.1): a table whose rows are words.
import { Letters, type AskedWord } from './letters.js';
import type { ObjectRow } from './object_blocks.js';
import type { ObjectRange, ObjectTable } from './object_table.js';
import { HierarchyProblem } from './problem.js';

/// A row's name is a word, a space and so many digits: the row's first object.
const FIRST_DIGITS = 6;
const MOST_OBJECTS = 4096; // of a row
/// A number has six bits in each letter, the lowest first; this bit says that it goes on.
const MORE_DIGITS = 0x40;
/// Blocks that are asked for at once.
const AT_ONCE = 8;

/// Where the rows of a word are.
export interface WordPlace {
  readonly asked: AskedWord;
  /// One range a block.
  readonly ranges: readonly ObjectRange[];
}

const KNOWN = new WeakMap<ObjectTable, ObjectWords>();

export class ObjectWords {
  private known: Promise<Letters> | null = null;

  /// The words of a table's names; null: it has none.
  static of({ words, count }: ObjectTable): ObjectWords | null {
    if (words !== null && !KNOWN.has(words)) KNOWN.set(words, new ObjectWords(words, count));
    return words && (KNOWN.get(words) ?? null);
  }

  /// `count`: there are so many objects.
  private constructor(
    private readonly table: ObjectTable,
    readonly count: number,
  ) {}

  letters(): Promise<Letters> {
    this.known ??= this.readLetters().catch((problem: unknown) => {
      this.known = null;
      throw problem;
    });
    return this.known;
  }

  async place(asked: AskedWord): Promise<WordPlace> {
    const range = await this.table.range(asked.isBeginning ? asked.word : `${asked.word} `);
    return { asked, ranges: await this.table.blocksOf(range) };
  }

  /// Puts those objects with a word that are at `level` on the next one. False: there are none.
  async raise({ ranges }: WordPlace, levels: Uint8Array, level: number, signal?: AbortSignal): Promise<boolean> {
    let raised = 0;
    for (let i = 0; i < ranges.length; i += AT_ONCE) {
      const rows = await Promise.all(ranges.slice(i, i + AT_ONCE).map((range) => this.table.rows(range)));
      signal?.throwIfAborted();
      for (const row of rows.flat()) for (const object of this.objectsOf(row)) {
        if (levels[object] !== level) continue;
        levels[object] = level + 1;
        ++raised;
      }
    }
    return raised > 0;
  }

  private async readLetters(): Promise<Letters> {
    const { name, values: [text] } = await this.table.row(0);
    const fail = (what: string): never => { throw new HierarchyProblem(this.table.file, what); };
    return new Letters(name === '' && typeof text === 'string' ? text : fail('lacks the table of letters'), fail);
  }

  /// The objects of a row, ascending.
  private objectsOf({ name, values: [value] }: ObjectRow): Uint32Array {
    const text = typeof value === 'string' ? value : '';
    const objects = new Uint32Array(Math.min(text.length, MOST_OBJECTS) + 1);
    const digits = name.slice(-FIRST_DIGITS - 1);
    let object = /^ [0-9a-f]{6}$/.test(digits) ? parseInt(digits, 16) : this.fail(name, 'have no first one');
    let [length, distance, unit] = [1, 0, 1];
    objects[0] = object;
    for (let i = 0; i < text.length; ++i) {
      const digit = text.charCodeAt(i);
      distance += (digit % MORE_DIGITS) * unit;
      unit *= MORE_DIGITS;
      if (digit >= 2 * MORE_DIGITS || unit > 2 ** 24) this.fail(name, 'have too long a number');
      if (digit >= MORE_DIGITS) continue;
      object += distance + 1;
      if (length === MOST_OBJECTS) this.fail(name, 'are too many');
      objects[length++] = object;
      [distance, unit] = [0, 1];
    }
    if (unit > 1 || object >= this.count) this.fail(name, 'are not all objects');
    return objects.subarray(0, length);
  }

  private fail(word: string, what: string): never {
    throw new HierarchyProblem(this.table.file, `the objects of the word "${word}" ${what}`);
  }
}
