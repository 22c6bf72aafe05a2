// SPDX-License-Identifier: MIT
// Words of names, in letters that are folded by the table that stands in the file (docs/file_format.md, section 9.1): the same words, whatever
// Unicode the browser knows.
import type { Fail } from '../json_value.js';

const MOST_WORD_LETTERS = 32;
const MOST_TARGETS = 32;
const LAST_CODE_POINT = 0x10ffff;
const SPACE = 0x20;
/// Kinds of rows, besides 0.
const RUNNING = 1;
const UNSPACED = 2;

/// A word that someone looks for; words that go on fit, too, where it is the beginning of one.
export interface AskedWord {
  readonly word: string;
  readonly isBeginning: boolean;
}

/// What code points become: every `step`-th one from `first` up to `last`.
interface Range {
  readonly first: number;
  readonly last: number;
  readonly step: number;
  readonly isRunning: boolean;
  readonly to: readonly number[];
}

/// Letters that stand together, all of scripts with spaces, or all of others.
interface Run {
  readonly isUnspaced: boolean;
  readonly letters: number[];
}

function textOf(letters: readonly number[]): string {
  return String.fromCodePoint(...letters.slice(0, MOST_WORD_LETTERS));
}

function rangeOf(ranges: readonly Range[], letter: number): Range | null {
  let [begin, end] = [0, ranges.length];
  while (begin < end) {
    const middle = (begin + end) >> 1;
    if (ranges[middle].first <= letter) begin = middle + 1;
    else end = middle;
  }
  const range = begin === 0 ? null : ranges[begin - 1];
  return range !== null && range.last >= letter ? range : null;
}

/// The letters of a syllable of Hangul (The Unicode Standard, section 3.12); null: it is none.
function hangul(letter: number): number[] | null {
  const syllable = letter - 0xac00;
  if (syllable < 0 || syllable >= 11172) return null;
  const [first, vowel, final] = [Math.floor(syllable / 588), Math.floor(syllable / 28) % 21, syllable % 28];
  return [0x1100 + first, 0x1161 + vowel, ...(final > 0 ? [0x11a7 + final] : [])];
}

export class Letters {
  private readonly ranges: Range[] = [];
  private readonly unspaced: Range[] = [];

  /// `fail`: is told what is wrong.
  constructor(text: string, private readonly fail: Fail) {
    const rows = text.split('\n');
    if (rows.pop() !== '') fail('the table of letters does not end');
    for (const row of rows) this.addRow(row.split(' ').map((number) => (/^[0-9a-f]{1,8}$/.test(number) ? parseInt(number, 16) : fail('the table of letters is not of hexadecimal numbers'))));
  }

  /// The words that a name must have to be found; the last one may be the beginning of a word.
  asked(text: string): AskedWord[] {
    const runs = this.runs(text);
    return runs.flatMap(({ isUnspaced, letters }, i): AskedWord[] => {
      if (!isUnspaced) return [{ word: textOf(letters), isBeginning: i === runs.length - 1 }];
      if (letters.length === 1) return [{ word: textOf(letters), isBeginning: true }];
      return letters.slice(1).map((letter, k) => ({ word: textOf([letters[k], letter]), isBeginning: false }));
    });
  }

  /// The words of a name, some perhaps twice.
  words(name: string): string[] {
    return this.runs(name).flatMap(({ isUnspaced, letters }) => (isUnspaced ? letters.map((_, i) => textOf(letters.slice(i, i + 2))) : [textOf(letters)]));
  }

  private addRow([first, count, step, kind, ...to]: number[]): void {
    const { fail } = this;
    const isRange = step > 0 && count > 0 && first + (count - 1) * step <= LAST_CODE_POINT;
    if (!isRange || !(kind <= UNSPACED) || to.length > MOST_TARGETS || (kind === RUNNING && to.length !== 1)) fail('a row of the table of letters is not as it must be');
    const last = first + (count - 1) * step;
    const ranges = kind === UNSPACED ? this.unspaced : this.ranges;
    if (to.some((letter) => letter + (kind === RUNNING ? last - first : 0) > LAST_CODE_POINT)) fail('the table of letters has something that is none');
    if (ranges.length > 0 && first <= ranges[ranges.length - 1].last) fail('the table of letters does not ascend');
    ranges.push({ first, last, step, isRunning: kind === RUNNING, to });
  }

  private folded(letter: number): readonly number[] {
    const syllable = hangul(letter);
    if (syllable !== null) return syllable;
    const range = rangeOf(this.ranges, letter);
    if (range === null || (letter - range.first) % range.step !== 0) return [letter];
    return range.isRunning ? [range.to[0] + letter - range.first] : range.to;
  }

  private runs(text: string): Run[] {
    const runs: Run[] = [];
    let goesOn = false;
    for (const letter of Array.from(text, (each) => this.folded(each.codePointAt(0) ?? SPACE)).flat()) {
      const isUnspaced = rangeOf(this.unspaced, letter) !== null;
      if (letter !== SPACE && (!goesOn || runs[runs.length - 1].isUnspaced !== isUnspaced)) runs.push({ isUnspaced, letters: [] });
      goesOn = letter !== SPACE;
      if (goesOn) runs[runs.length - 1].letters.push(letter);
    }
    return runs;
  }
}

/// Whether a name of these words is found.
export function fits(words: readonly string[], asked: readonly AskedWord[]): boolean {
  return asked.every(({ word: wanted, isBeginning }) => words.some((word) => (isBeginning ? word.startsWith(wanted) : word === wanted)));
}
