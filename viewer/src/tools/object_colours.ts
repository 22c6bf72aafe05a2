// SPDX-License-Identifier: MIT
// A colour for each object by one of its properties: along a ramp, or one for each of the values.
import type { ObjectRow, ObjectValue } from '../hierarchy/object_blocks.js';
import type { ObjectProperty } from '../hierarchy/object_facts.js';
import { labelColour, rampColour, type RampName } from '../scene/ramps.js';

type Rgb = readonly [number, number, number];

/// What the colours mean.
export interface ObjectLegend {
  readonly property: ObjectProperty;
  /// The least and the greatest of numbers; null: there are other values, or no numbers.
  readonly range: readonly [number, number] | null;
  /// All values but numbers, the most frequent first.
  readonly values: readonly { readonly value: ObjectValue; readonly count: number; readonly colour: Rgb }[];
}

export interface ObjectColours {
  /// Red, green, blue and 255 of each object, or four zeros: it has no value.
  readonly bytes: Uint8Array;
  readonly legend: ObjectLegend;
}

function rangeOf(numbers: readonly number[]): readonly [number, number] | null {
  return numbers.length === 0 ? null : numbers.reduce<[number, number]>(([least, most], value) => [Math.min(least, value), Math.max(most, value)], [Infinity, -Infinity]);
}

/// Values that many objects have come first, and of as many the smaller text.
function valuesOf(values: readonly ObjectValue[]): ObjectLegend['values'] {
  const counts = new Map<ObjectValue, number>();
  for (const value of values) counts.set(value, (counts.get(value) ?? 0) + 1);
  const sorted = [...counts].sort(([a, many], [b, more]) => more - many || (String(a) < String(b) ? -1 : 1));
  return sorted.map(([value, count], i) => ({ value, count, colour: labelColour(i) }));
}

/// `rows`: all objects; `at`: the place of the property among their values.
export function colourObjects(rows: readonly ObjectRow[], property: ObjectProperty, at: number, ramp: RampName): ObjectColours {
  const there = rows.map(({ values }) => values[at]).filter((value) => value !== null);
  const range = rangeOf(there.filter((value) => typeof value === 'number'));
  const values = range === null ? valuesOf(there) : [];
  const known = new Map(values.map(({ value, colour }) => [value, colour]));
  const bytes = new Uint8Array(4 * rows.length);
  rows.forEach(({ values: own }, object) => {
    const value = own[at];
    const colour = typeof value === 'number' && range !== null ? rampColour(ramp, (value - range[0]) / (range[1] - range[0] || 1)) : known.get(value);
    if (colour !== undefined) bytes.set([...colour, 255], 4 * object);
  });
  return { bytes, legend: { property, range, values } };
}
