// SPDX-License-Identifier: MIT
// The parts of objects.bin once they are unpacked: its directory, and blocks of objects (docs/file_format.md, section 9).
import type { Fail } from '../json_value.js';
import { ColumnReader, compareBytes } from './byte_columns.js';
import { HEAD_BYTES, PROPERTY_TYPES, type ObjectProperty, type ObjectPropertyType } from './object_facts.js';

const MOST_BLOCK_OBJECTS = 256;
/// A key that is so long may be the beginning of a name only.
export const MOST_KEY_BYTES = 255;
const MOST_TEXT_BYTES = 2 ** 20; // of one object
const MOST_BLOCK_BYTES = MOST_TEXT_BYTES + MOST_BLOCK_OBJECTS * (128 + 16 * 64);

/// As the property's type says; a date as ISO 8601 has it; null: it has none.
export type ObjectValue = number | boolean | string | null;

export interface ObjectBox {
  readonly min: readonly [number, number, number];
  readonly max: readonly [number, number, number];
}

/// All that is known of an object.
export interface ObjectRow {
  readonly object: number;
  /// Empty: the faces of no object.
  readonly name: string;
  /// One value a property.
  readonly values: readonly ObjectValue[];
  /// Holds its triangles, in the input's coordinates; null: it has none.
  readonly box: ObjectBox | null;
  readonly triangles: number;
  /// Its triangles have this area together, in the input's units.
  readonly area: number;
}

/// Where objects that follow each other are.
export interface BlockPlace {
  /// Its bytes in the file.
  readonly begin: number;
  readonly end: number;
  readonly unpacked: number;
  /// XXH3-64.
  readonly checksum: bigint;
  readonly first: number;
  readonly count: number;
  readonly key: Uint8Array;
}

function isSameProperty(a: ObjectProperty, b: ObjectProperty | undefined): boolean {
  return a.name === b?.name && a.type === b.type;
}

function readOwnProperties(columns: ColumnReader, count: number): ObjectProperty[] {
  const types = columns.bytesOf(count);
  return columns.texts(count).map((name, i) => ({ name: columns.decoded(name), type: PROPERTY_TYPES[types[i]] ?? columns.fail('a property has an unknown type') }));
}

/// Reads the directory of a file with `count` objects, whose blocks end at `end`. `fail`: is told what is wrong.
export function readDirectory(bytes: Uint8Array, properties: readonly ObjectProperty[], count: number, end: number, fail: Fail): BlockPlace[] {
  const columns = new ColumnReader(bytes, fail);
  const [own] = columns.u32(1);
  const [blocks] = columns.u32(1);
  if (own !== properties.length || !readOwnProperties(columns, own).every((each, i) => isSameProperty(each, properties[i]))) fail('its properties are not those of the manifest');
  const [counts, sizes, unpacked] = [columns.u32(blocks), columns.u32(blocks), columns.u32(blocks)];
  const sums = columns.u64(blocks);
  const keys = columns.texts(blocks);
  columns.finish();
  let [first, begin] = [0, HEAD_BYTES];
  const places = counts.map((objects, i): BlockPlace => {
    const isSound = objects >= 1 && objects <= MOST_BLOCK_OBJECTS && sizes[i] >= 1 && Math.max(sizes[i], unpacked[i]) <= MOST_BLOCK_BYTES;
    if (!isSound || keys[i].length > MOST_KEY_BYTES || (i > 0 && !mayFollow(keys[i], keys[i - 1]))) fail('a block is not as it must be');
    first += objects;
    begin += sizes[i];
    return { begin: begin - sizes[i], end: begin, unpacked: unpacked[i], checksum: sums[i], first: first - objects, count: objects, key: keys[i] };
  });
  if (first !== count || begin !== end) fail('its blocks are not all of the file');
  return places;
}

/// Keys ascend, but that long ones may be alike.
function mayFollow(key: Uint8Array, before: Uint8Array): boolean {
  const order = compareBytes(key, before);
  return order > 0 || (order === 0 && key.length === MOST_KEY_BYTES);
}

/// Objects of one block.
export interface ObjectBlock {
  readonly names: readonly Uint8Array[];
  readonly rows: readonly ObjectRow[];
}

function readBoxes(columns: ColumnReader, count: number): (ObjectBox | null)[] {
  const boxes = Array<ObjectBox | null>(count).fill(null);
  const marked = columns.marked(count);
  const n = Array.from({ length: 6 }, () => columns.f64(marked.length));
  marked.forEach((row, k) => {
    const box: ObjectBox = { min: [n[0][k], n[1][k], n[2][k]], max: [n[3][k], n[4][k], n[5][k]] };
    if (box.min.some((least, axis) => least > box.max[axis])) columns.fail('a box is turned');
    boxes[row] = box;
  });
  return boxes;
}

function readValues(columns: ColumnReader, type: ObjectPropertyType, count: number): ObjectValue[] {
  const values = Array<ObjectValue>(count).fill(null);
  const marked = columns.marked(count);
  const readers: Record<ObjectPropertyType, () => readonly ObjectValue[]> = {
    number: () => columns.f64(marked.length),
    boolean: () => {
      const flags = Array<boolean>(marked.length).fill(false);
      for (const i of columns.marked(marked.length)) flags[i] = true;
      return flags;
    },
    text: () => columns.texts(marked.length).map((text) => columns.decoded(text)),
    date: () => readers.text(),
  };
  readers[type]().forEach((value, k) => { values[marked[k]] = value; });
  return values;
}

/// Takes the values of a property, without looking at them.
function skipValues(columns: ColumnReader, type: ObjectPropertyType, count: number): void {
  const there = columns.marked(count).length;
  if (type === 'text' || type === 'date') columns.texts(there);
  else columns.bytesOf(there * (type === 'number' ? 8 : 1));
}

/// Reads of a block the values of one property. `fail`: is told what is wrong.
export function readColumn(bytes: Uint8Array, { count }: BlockPlace, properties: readonly ObjectProperty[], at: number, fail: Fail): ObjectValue[] {
  const columns = new ColumnReader(bytes, fail);
  columns.texts(count); // names
  columns.bytesOf(48 * columns.marked(count).length); // boxes
  columns.bytesOf(16 * count); // triangles and areas
  for (const { type } of properties.slice(0, at)) skipValues(columns, type, count);
  return readValues(columns, properties[at].type, count);
}

/// Reads a block. `fail`: is told what is wrong.
export function readBlock(bytes: Uint8Array, { first, count, key }: BlockPlace, properties: readonly ObjectProperty[], fail: Fail): ObjectBlock {
  const columns = new ColumnReader(bytes, fail);
  const names = columns.texts(count);
  if (names.some((name, i) => i > 0 && compareBytes(name, names[i - 1]) <= 0)) fail('the names do not ascend');
  if (compareBytes(names[0].subarray(0, MOST_KEY_BYTES), key) !== 0) fail('does not begin with the name in the directory');
  const boxes = readBoxes(columns, count);
  const triangles = columns.u64(count);
  const areas = columns.f64(count);
  const values = properties.map(({ type }) => readValues(columns, type, count));
  columns.finish();
  const rows = names.map((name, i): ObjectRow => ({
    object: first + i, name: columns.decoded(name), values: values.map((column) => column[i]), box: boxes[i], triangles: Number(triangles[i]), area: areas[i],
  }));
  return { names, rows };
}
