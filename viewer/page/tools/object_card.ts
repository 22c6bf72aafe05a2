// SPDX-License-Identifier: MIT
// What is known of an object: its name, properties and size, each of which can be copied as it is in the table.
import type { ObjectProperty } from '../../src/hierarchy/object_facts.js';
import type { ObjectRow, ObjectValue } from '../../src/hierarchy/object_blocks.js';
import type { LengthScale } from '../../src/tools/units.js';
import { formatCount, formatNumber } from '../numbers.js';
import { line, type Figure } from './figures.js';
import { words } from './words/words.js';

/// The address that a text is; null: it is none that a page may lead to.
export function safeLink(text: string): string | null {
  if (!/^https?:\/\/\S+$/i.test(text)) return null;
  try {
    const { protocol, href } = new URL(text);
    return protocol === 'http:' || protocol === 'https:' ? href : null;
  } catch {
    return null;
  }
}

/// A line whose text may be an address.
function textLine(name: string, shown: string, copied: string): Figure {
  return { ...line(name, shown, copied), link: safeLink(copied) };
}

function told(value: ObjectValue): string {
  if (typeof value === 'boolean') return value ? words.objects.yes : words.objects.no;
  return typeof value === 'number' ? formatNumber(value) : (value ?? '–');
}

function propertyLines(properties: readonly ObjectProperty[], { values }: ObjectRow): Figure[] {
  return properties.flatMap(({ name }, i) => (values[i] === null ? [] : [textLine(name, told(values[i]), String(values[i]))]));
}

function sizeLines({ box, area, triangles }: ObjectRow, scale: LengthScale): Figure[] {
  const { objects: text } = words;
  const sides = box?.max.map((most, axis) => most - box.min[axis]) ?? [];
  return [
    ...(box === null ? [] : [line(text.size, scale.formatSides(sides), sides.map((side) => side * scale.factor).join(' '))]),
    line(text.area, scale.formatArea(area), area * scale.factor ** 2), line(text.triangles, formatCount(triangles), triangles),
  ];
}

/// Returns the lines of an object; `null`: nothing is picked.
export function objectLines(row: ObjectRow | null, properties: readonly ObjectProperty[], scale: LengthScale): Figure[] {
  if (row === null) return [];
  const name = textLine(words.objects.name, row.name === '' ? words.objects.noName : row.name, row.name);
  return [name, ...propertyLines(properties, row), ...sizeLines(row, scale)];
}
