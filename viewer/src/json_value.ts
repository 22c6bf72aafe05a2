// SPDX-License-Identifier: MIT
// JSON of strangers: each value is asked for as the type that it must have.
import { areNear, FARTHEST } from './farthest.js';

/// An object whose values may be anything.
export type Json = Readonly<Record<string, unknown>>;

/// Returns an object as it is, and one without anything for all else.
export function asObject(value: unknown): Json {
  return typeof value === 'object' && value !== null ? (value as Json) : {};
}

/// Is told what is wrong, and must throw.
export type Fail = (what: string) => never;

export class JsonValue {
  private constructor(
    private readonly value: unknown,
    private readonly path: string,
    private readonly refuse: Fail,
  ) {}

  static parse(text: string, refuse: Fail): JsonValue {
    let value: unknown;
    try {
      value = JSON.parse(text);
    } catch {
      refuse('not JSON');
    }
    return new JsonValue(value, '', refuse);
  }

  /// What was read elsewhere; `path`: its name in messages.
  static of(value: unknown, path: string, refuse: Fail): JsonValue {
    return new JsonValue(value, path, refuse);
  }

  /// Says that it is not what was expected.
  fail(expected: string): never {
    return this.refuse(this.path === '' ? `not ${expected}` : `"${this.path}" is not ${expected}`);
  }

  /// A value that was made of it, where that is sound.
  which<Value>(value: Value, isSound: (value: Value) => boolean, expected: string): Value {
    return isSound(value) ? value : this.fail(expected);
  }

  at(key: string | number): JsonValue {
    if (typeof this.value !== 'object' || this.value === null) this.fail('an object');
    const below = Object.hasOwn(this.value, key) ? (this.value as Record<string | number, unknown>)[key] : undefined;
    return new JsonValue(below, this.path === '' ? String(key) : `${this.path}.${key}`, this.refuse);
  }

  has(key: string): boolean {
    return this.at(key).value !== undefined;
  }

  items(): JsonValue[] {
    if (!Array.isArray(this.value)) this.fail('an array');
    return this.value.map((_, i) => this.at(i));
  }

  /// The items of an array, or the value alone.
  oneOrMore(): JsonValue[] {
    return Array.isArray(this.value) ? this.items() : [this];
  }

  entries(): [string, JsonValue][] {
    if (typeof this.value !== 'object' || this.value === null || Array.isArray(this.value)) this.fail('an object');
    return Object.keys(this.value).map((key) => [key, this.at(key)]);
  }

  isNull(): boolean {
    return this.value === null;
  }

  isText(text?: string): boolean {
    return typeof this.value === 'string' && (text === undefined || this.value === text);
  }

  isObject(): boolean {
    return typeof this.value === 'object' && this.value !== null;
  }

  flag(): boolean {
    return typeof this.value === 'boolean' ? this.value : this.fail('true or false');
  }

  text(): string {
    return typeof this.value === 'string' ? this.value : this.fail('a text');
  }

  oneOf<Text extends string>(...texts: readonly Text[]): Text {
    return texts.find((text) => text === this.value) ?? this.fail(`one of ${texts.join(', ')}`);
  }

  number(): number {
    return typeof this.value === 'number' && Number.isFinite(this.value) ? this.value : this.fail('a number');
  }

  /// A coordinate of a place that somebody names.
  coordinate(): number {
    const value = this.number();
    return areNear([value]) ? value : this.fail(`from ${-FARTHEST} to ${FARTHEST}`);
  }

  place(): [number, number, number] {
    return [this.at(0).coordinate(), this.at(1).coordinate(), this.at(2).coordinate()];
  }

  /// An integer from `least` to `most`.
  count(least = 0, most = Number.MAX_SAFE_INTEGER): number {
    const value = this.number();
    return Number.isInteger(value) && value >= least && value <= most ? value : this.fail(`from ${least} to ${most}`);
  }

  triple(): [number, number, number] {
    return [this.at(0).number(), this.at(1).number(), this.at(2).number()];
  }

  /// So many of them.
  numbers(count: number): number[] {
    return Array.from({ length: count }, (_, i) => this.at(i).number());
  }

  /// Sixteen digits.
  checksum(): string {
    const text = this.text();
    return /^[0-9a-f]{16}$/.test(text) ? text : this.fail('a checksum');
  }

  /// The name of a file that lies beside the one that names it.
  fileName(): string {
    const name = this.text();
    return /^[A-Za-z0-9_]+\.[a-z0-9]+$/.test(name) ? name : this.fail('a file name');
  }
}
