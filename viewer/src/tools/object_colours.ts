// SPDX-License-Identifier: MIT
// A colour for each object by one of its properties: along a ramp, or one for each of the values. Values come in parts, as a table is read.
import type { ObjectValue } from '../hierarchy/object_blocks.js';
import type { ObjectProperty } from '../hierarchy/object_facts.js';
import type { ColumnPart } from '../hierarchy/object_table.js';
import { labelColour, rampColour, type RampName } from '../scene/ramps.js';

type Rgb = readonly [number, number, number];
type Range = readonly [number, number];

/// Values besides numbers that have a colour of their own; objects with others look as they are.
const MOST_VALUES = 2 ** 16;
const RAMP_COLOURS = 256;

/// What the colours mean.
export interface ObjectLegend {
  readonly property: ObjectProperty;
  /// The numbers at which the ramp begins and ends; null: there are other values, or no numbers.
  readonly range: Range | null;
  /// The least and the greatest of all numbers.
  readonly whole: Range | null;
  /// All values but numbers, the most frequent first.
  readonly values: readonly { readonly value: ObjectValue; readonly count: number; readonly colour: Rgb }[];
}

interface Category {
  readonly value: ObjectValue;
  count: number;
}

/// Values that many objects have come first, and of as many the smaller text.
function inOrder(categories: readonly Category[]): number[] {
  return [...categories.keys()].sort((a, b) => categories[b].count - categories[a].count || (String(categories[a].value) < String(categories[b].value) ? -1 : 1));
}

/// The values of one property, four bytes an object.
export class ObjectColours {
  private readonly numbers: Float32Array; // NaN: there is none
  private readonly codes: Uint32Array; // the number of a category and one; 0: there is none
  private readonly categories: Category[] = [];
  private readonly known = new Map<ObjectValue, number>();
  private least = Infinity;
  private most = -Infinity;
  /// Null: from the least number to the greatest.
  range: Range | null = null;

  /// `count`: of all objects.
  constructor(private readonly property: ObjectProperty, count: number, readonly ramp: RampName) {
    this.numbers = new Float32Array(property.type === 'number' ? count : 0).fill(NaN);
    this.codes = new Uint32Array(property.type === 'number' ? 0 : count);
  }

  add({ first, values }: ColumnPart): void {
    values.forEach((value, i) => {
      if (typeof value === 'number') this.addNumber(first + i, value);
      else if (value !== null) this.codes[first + i] = this.codeOf(value);
    });
  }

  legend(): ObjectLegend {
    const whole: Range | null = this.least <= this.most ? [this.least, this.most] : null;
    const values = inOrder(this.categories).map((code, i) => ({ ...this.categories[code], colour: labelColour(i) }));
    return { property: this.property, range: whole && (this.range ?? whole), whole, values };
  }

  /// Writes red, green, blue and 255 of each object, or four zeros: it has no value.
  paint(bytes: Uint8Array): void {
    if (this.property.type === 'number') this.paintNumbers(bytes);
    else this.paintCategories(bytes);
  }

  private addNumber(object: number, value: number): void {
    this.numbers[object] = value;
    this.least = Math.min(this.least, value);
    this.most = Math.max(this.most, value);
  }

  private codeOf(value: ObjectValue): number {
    let code = this.known.get(value);
    if (code === undefined) {
      if (this.categories.length === MOST_VALUES) return 0;
      code = this.categories.push({ value, count: 0 });
      this.known.set(value, code);
    }
    ++this.categories[code - 1].count;
    return code;
  }

  private paintNumbers(bytes: Uint8Array): void {
    const [from, to] = this.range ?? [this.least, this.most];
    const colours = Array.from({ length: RAMP_COLOURS }, (_, i) => packed(rampColour(this.ramp, i / (RAMP_COLOURS - 1))));
    const words = new Uint32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);
    this.numbers.forEach((value, object) => {
      const part = (value - from) / (to - from || 1);
      words[object] = Number.isNaN(value) ? 0 : colours[Math.round(Math.min(Math.max(part, 0), 1) * (RAMP_COLOURS - 1))];
    });
  }

  private paintCategories(bytes: Uint8Array): void {
    const colours = new Uint32Array(this.categories.length + 1);
    inOrder(this.categories).forEach((code, i) => { colours[code + 1] = packed(labelColour(i)); });
    const words = new Uint32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);
    this.codes.forEach((code, object) => { words[object] = colours[code]; });
  }
}

/// The four bytes of a colour, in the order of memory.
function packed([red, green, blue]: Rgb): number {
  return new Uint32Array(Uint8Array.of(red, green, blue, 255).buffer)[0];
}
