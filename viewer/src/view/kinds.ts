// SPDX-License-Identifier: MIT
// Kinds of values that a view has: how links write them, how JSON has them, and which are sound.
import type { JsonValue } from '../json_value.js';

export interface Kind<Value> {
  /// From what a link has of a key, unescaped, once for each time that it stands there; null: nothing that can be read.
  parse(texts: readonly string[]): Value | null;
  /// What a link has of it, escaped: the key stands there once for each text.
  format(value: Value): readonly string[];
  /// From JSON. Refuses what is none.
  read(json: JsonValue): Value;
  toJson(value: Value): unknown;
}

const DIGITS = 12;

/// A number as links keep it.
export function rounded(value: number, digits = DIGITS): number {
  return Number(value.toPrecision(digits));
}

/// A plus would be a space in a link.
export function formatNumber(value: number, digits = DIGITS): string {
  return String(rounded(value, digits)).replace('e+', 'e');
}

/// NaN: it is none.
function parseNumber(text: string): number {
  return text.trim() === '' ? NaN : Number(text);
}

function parseNumbers(text: string): number[] {
  return text === '' ? [] : text.split(',').map(parseNumber);
}

function same(value: unknown): unknown {
  return value;
}

/// A key that stands in a link once is of this kind.
function single<Value>(parse: (text: string) => Value | null, format: (value: Value) => string, read: Kind<Value>['read']): Kind<Value> {
  return { parse: ([text]) => (text === undefined ? null : parse(text)), format: (value) => [format(value)], read, toJson: same };
}

export function word<Word extends string>(words: readonly Word[]): Kind<Word> {
  return single((text) => words.find((each) => each === text) ?? null, (value) => value, (json) => json.oneOf(...words));
}

export function flag(): Kind<boolean> {
  return single<boolean>((text) => (text === 'on' ? true : text === 'off' ? false : null), (value) => (value ? 'on' : 'off'), (json) => json.flag());
}

/// `expected`: what sound ones are, in words.
export function text(isSound: (text: string) => boolean, expected: string): Kind<string> {
  return single((given) => (isSound(given) ? given : null), encodeURIComponent, (json) => json.which(json.text(), isSound, expected));
}

export function texts(most: number): Kind<readonly string[]> {
  return {
    parse: (given) => (given.length === 0 ? null : given.slice(0, most)),
    format: (values) => values.map(encodeURIComponent),
    read: (json) => json.which(json.items().map((item) => item.text()), ({ length }) => length <= most, `at most ${most} texts`),
    toJson: same,
  };
}

export function number(isSound: (value: number) => boolean, expected: string): Kind<number> {
  const isOne = (value: number): boolean => Number.isFinite(value) && isSound(value);
  return single((given) => (isOne(parseNumber(given)) ? parseNumber(given) : null), (value) => formatNumber(value), (json) => json.which(json.number(), isOne, expected));
}

/// Finite ones: `List` is what `isSound` lets pass.
export function numbers<List extends readonly number[] = readonly number[]>(isSound: (values: readonly number[]) => boolean, expected: string): Kind<List> {
  const isList = (values: readonly number[]): values is List => values.every(Number.isFinite) && isSound(values);
  const parse = (given: string): List | null => {
    const values = parseNumbers(given);
    return isList(values) ? values : null;
  };
  const read = (json: JsonValue): List => json.which(json.items().map((item) => item.number()), isList, expected) as unknown as List;
  return single(parse, (values) => values.map((value) => formatNumber(value)).join(','), read);
}
