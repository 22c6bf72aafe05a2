// SPDX-License-Identifier: MIT
// Writes tables of objects for tests, as docs/file_format.md says (section 9).
import { gzipSync } from 'node:zlib';
import { checksum, digitsOf } from '../../src/hierarchy/checksum.js';
import type { ObjectRow, ObjectValue } from '../../src/hierarchy/object_blocks.js';

const BLOCK = 256;

/// Little endian numbers of so many bytes, in planes.
export function planes(width: number, values: readonly bigint[]): number[] {
  return Array.from({ length: width }, (_, plane) => values.map((value) => Number((value >> BigInt(8 * plane)) & 255n))).flat();
}

export function u32(...values: number[]): number[] {
  return planes(4, values.map(BigInt));
}

export function f64(...values: number[]): number[] {
  return planes(8, [...new BigUint64Array(new Float64Array(values).buffer)]);
}

export function texts(...values: number[][]): number[] {
  return [...u32(...values.map(({ length }) => length)), ...values.flat()];
}

function utf8(text: string): number[] {
  return [...Buffer.from(text)];
}

function column(values: readonly ObjectValue[]): number[] {
  const there = values.filter((value) => value !== null);
  const marks = values.map((value) => (value === null ? 0 : 1));
  if (typeof there[0] === 'number') return [...marks, ...f64(...there.map(Number))];
  if (typeof there[0] === 'boolean') return [...marks, ...there.map(Number)];
  return [...marks, ...(there.length === 0 ? [] : texts(...there.map((text) => utf8(String(text)))))];
}

export type NewRow = Omit<ObjectRow, 'object'>;

function blockOf(rows: readonly NewRow[], properties: number): number[] {
  const boxes = rows.flatMap(({ box }) => (box === null ? [] : [[...box.min, ...box.max]]));
  return [
    ...texts(...rows.map(({ name }) => utf8(name))), ...rows.map(({ box }) => (box === null ? 0 : 1)), ...[0, 1, 2, 3, 4, 5].flatMap((k) => f64(...boxes.map((box) => box[k]))),
    ...planes(8, rows.map(({ triangles }) => BigInt(triangles))), ...f64(...rows.map(({ area }) => area)),
    ...Array.from({ length: properties }, (_, k) => column(rows.map(({ values }) => values[k]))).flat(),
  ];
}

export interface WrittenTable {
  readonly bytes: Uint8Array<ArrayBuffer>;
  /// What the manifest tells of it.
  readonly json: object;
}

/// `rows`: ascending by name, with names of less than 256 bytes.
export function tableOfRows(rows: readonly NewRow[], properties: readonly { readonly name: string; readonly type: string }[]): WrittenTable {
  const groups = Array.from({ length: Math.ceil(rows.length / BLOCK) }, (_, i) => rows.slice(BLOCK * i, BLOCK * (i + 1)));
  const plain = groups.map((group) => Uint8Array.from(blockOf(group, properties.length)));
  const packed = plain.map((block) => new Uint8Array(gzipSync(block)));
  const types = properties.map(({ type }) => ['number', 'boolean', 'text', 'date'].indexOf(type));
  const directory = Uint8Array.from([
    ...u32(properties.length), ...u32(groups.length), ...types, ...texts(...properties.map(({ name }) => utf8(name))), ...u32(...groups.map(({ length }) => length)),
    ...u32(...packed.map(({ length }) => length)), ...u32(...plain.map(({ length }) => length)), ...planes(8, packed.map((block) => checksum(block))), ...texts(...groups.map(([{ name }]) => utf8(name))),
  ]);
  const packedDirectory = new Uint8Array(gzipSync(directory));
  const sum = checksum(packedDirectory);
  const end = Uint8Array.from([packedDirectory.length, directory.length].flatMap((size) => planes(8, [BigInt(size)])).concat(planes(8, [sum])));
  const bytes = new Uint8Array(Buffer.concat([Buffer.from('MHTABLE\n\u0001\0\0\0', 'latin1'), ...packed, packedDirectory, end]));
  const json = { file: 'objects.bin', bytes: bytes.length, checksum: digitsOf(checksum(bytes)), count: rows.length, directory: { bytes: packedDirectory.length, checksum: digitsOf(sum) }, properties };
  return { bytes, json };
}
