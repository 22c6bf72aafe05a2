// SPDX-License-Identifier: MIT
import { gzipSync } from 'node:zlib';
import { describe, expect, it } from 'vitest';
import { JsonValue } from '../../src/json_value.js';
import { checksum } from '../../src/hierarchy/checksum.js';
import { compareBytes } from '../../src/hierarchy/byte_columns.js';
import type { ObjectRow } from '../../src/hierarchy/object_blocks.js';
import { readObjectFacts, type ObjectFacts, type TableFacts } from '../../src/hierarchy/object_facts.js';
import { ObjectTable } from '../../src/hierarchy/object_table.js';
import { HierarchyProblem } from '../../src/hierarchy/problem.js';
import { fittingNames } from '../../src/tools/object_names.js';
import { f64, planes, tableOfRows, texts, u32 } from '../support/object_table.js';
import { TABLE_JSON, tableBytes } from './object_table_bytes.js';

function factsOf(json: object): ObjectFacts {
  return readObjectFacts(JsonValue.parse(JSON.stringify(json), (what) => { throw new HierarchyProblem('hierarchy.json', what); }));
}

/// A host that counts what it is asked for; `isWhole`: it knows no ranges.
function tableOf(bytes = tableBytes(), { isWhole = false, json = TABLE_JSON }: { isWhole?: boolean; json?: object } = {}): { table: ObjectTable; asked: [number, number][] } {
  const asked: [number, number][] = [];
  const table = new ObjectTable(factsOf(json), (first, end) => {
    asked.push([first, end]);
    return Promise.resolve(isWhole ? bytes.slice() : bytes.slice(first, end));
  });
  return { table, asked };
}

/// As the fixture was made.
function room(i: number): Omit<ObjectRow, 'object'> {
  const date = `19${String(i % 100).padStart(2, '0')}-06-15`;
  return {
    name: `Straße ${String.fromCharCode(65 + Math.floor(i / 100))}/room ${String(i % 100).padStart(2, '0')}`,
    values: [i % 3 ? i / 8 : null, i % 5 ? i % 2 === 0 : null, i % 4 ? (i % 2 ? 'school' : 'café') : null, i % 7 ? date : null],
    box: i % 10 ? { min: [i, -2, 0], max: [i + 1, 2, i / 8] } : null,
    triangles: 12,
    area: 0.5 * i,
  };
}

const LONG = 'b'.repeat(300);

describe('a table of objects', () => {
  it('has the rows that the program wrote', async () => {
    const { table } = tableOf();
    const rows = await table.rows({ begin: 0, end: table.count });
    expect(rows.map(({ object }) => object)).toEqual(Array.from({ length: 820 }, (_, i) => i));
    expect(rows[0]).toMatchObject({ name: '', values: [null, null, null, null], box: null, triangles: 7, area: 1.5 });
    for (let i = 1; i < 520; ++i) expect(rows[i]).toEqual({ object: i, ...room(i) });
    expect(rows[519 + 300].name).toBe(`${LONG}299`);
  });

  it('finds names, also such that begin alike for long', async () => {
    const { table } = tableOf();
    for (const i of [1, 99, 100, 255, 256, 257, 511, 519]) expect((await table.find(room(i).name))?.object).toBe(i);
    for (const i of [0, 1, 150, 299]) expect((await table.find(`${LONG}${String(i).padStart(3, '0')}`))?.object).toBe(520 + i);
    expect((await table.find(''))?.object).toBe(0);
    for (const name of ['a', 'Straße', 'Straße A/room 0', LONG, `${LONG}300`, '\u{1f3e0}']) expect(await table.find(name)).toBeNull();
  });

  it('has a range for each prefix', async () => {
    const { table } = tableOf();
    expect(await table.range('')).toEqual({ begin: 0, end: 820 });
    expect(await table.range('Straße ')).toEqual({ begin: 1, end: 520 });
    expect(await table.range('Straße C/')).toEqual({ begin: 200, end: 300 });
    expect(await table.range(`${LONG}1`)).toEqual({ begin: 620, end: 720 });
    expect(await table.range('Str\u00e4')).toEqual({ begin: 520, end: 520 });
    expect(await table.range('zz')).toEqual({ begin: 820, end: 820 });
    expect((await table.startingWith('Straße B/room 1', 3)).map(({ name }) => name)).toEqual(['Straße B/room 10', 'Straße B/room 11', 'Straße B/room 12']);
  });

  it('asks for its directory once, and for a block a question', async () => {
    const { table, asked } = tableOf();
    await Promise.all([table.row(300), table.row(301)]);
    expect(asked).toHaveLength(2);
    await table.row(302);
    await table.find(room(303).name);
    expect(asked).toHaveLength(2);
    await table.row(1);
    expect(asked).toHaveLength(3);
    expect(asked.every(([first, end]) => end - first < 2500)).toBe(true);
  });

  it('comes from a host without ranges in one answer', async () => {
    const { table, asked } = tableOf(tableBytes(), { isWhole: true });
    expect((await table.row(7)).name).toBe(room(7).name);
    expect((await table.row(700)).name).toBe(`${LONG}180`);
    expect(asked).toHaveLength(1);
  });

  it('asks again for what failed', async () => {
    let isDown = true;
    const bytes = tableBytes();
    const table = new ObjectTable(factsOf(TABLE_JSON), (first, end) => {
      if (isDown) throw new HierarchyProblem('objects.bin', 'the host answered 503', true);
      return Promise.resolve(bytes.slice(first, end));
    });
    await expect(table.row(1)).rejects.toThrow('503');
    isDown = false;
    expect((await table.row(1)).object).toBe(1);
  });
});

describe('a table that is damaged', () => {
  it('is refused wherever a byte of it is another one', async () => {
    const good = tableBytes();
    const read = async (bytes: Uint8Array<ArrayBuffer>): Promise<unknown> => {
      const { table } = tableOf(bytes);
      return table.rows({ begin: 0, end: table.count });
    };
    for (let at = 12; at < good.length - 24; at += 13) {
      const bytes = good.slice();
      bytes[at] ^= 1 << at % 8;
      await expect(read(bytes), `byte ${at}`).rejects.toBeInstanceOf(HierarchyProblem);
    }
  });

  it.each([
    ['count', 0], ['count', 2 ** 24 + 1], ['bytes', 30], ['file', '../objects.bin'], ['directory', { bytes: 5000, checksum: '32457757cff3979e' }],
    ['properties', [{ name: 'a', type: 'integer' }]], ['properties', {}],
  ])('is refused where the manifest says of %s: %j', (key, value) => {
    expect(() => factsOf({ ...TABLE_JSON, [key]: value })).toThrow(HierarchyProblem);
  });

  it.each([['count', 821], ['bytes', 4754], ['properties', []], ['properties', [{ name: 'height', type: 'text' }, ...TABLE_JSON.properties.slice(1)]]])('is refused where the manifest tells something else of %s', async (key, value) => {
    await expect(tableOf(tableBytes(), { json: { ...TABLE_JSON, [key]: value } }).table.row(0)).rejects.toBeInstanceOf(HierarchyProblem);
  });
});

/// A file of one block with one property, whose checksums are right.
function forged(block: readonly number[], { count = 1, key = [97], type = 0, name = 'p' } = {}): ObjectTable {
  const packed = gzipSync(Uint8Array.from(block));
  const directory = gzipSync(Uint8Array.from([
    ...u32(1), ...u32(1), type, ...texts([...Buffer.from('p')]), ...u32(count), ...u32(packed.length), ...u32(block.length), ...planes(8, [checksum(packed)]), ...texts(key),
  ]));
  const bytes = Buffer.concat([Buffer.alloc(12), packed, directory, Buffer.alloc(24)]);
  const facts: TableFacts = {
    file: 'objects.bin', bytes: bytes.length, count, properties: [{ name, type: (['number', 'boolean', 'text', 'date'] as const)[type] ?? 'number' }],
    directory: { bytes: directory.length, checksum: checksum(directory) },
  };
  return new ObjectTable(facts, (first, end) => Promise.resolve(new Uint8Array(bytes.subarray(first, end))));
}

/// One object.
function block({ name = [97], box = [0], area = 1, value = [0] as number[] } = {}): number[] {
  return [...texts(name), ...box, ...planes(8, [12n]), ...f64(area), ...value];
}

describe('what no program writes', () => {
  it('is told from what one does', async () => {
    expect(await forged(block({ box: [1, ...[0, 0, 0, 1, 2, 3].flatMap((x) => f64(x))], value: [1, ...f64(7)] })).row(0)).toEqual({
      object: 0, name: 'a', box: { min: [0, 0, 0], max: [1, 2, 3] }, triangles: 12, area: 1, values: [7],
    });
  });

  it.each([
    ['a name that is no UTF-8', forged(block({ name: [0xed, 0xa0, 0x80] }), { key: [0xed, 0xa0, 0x80] })],
    ['another name than the directory has', forged(block({ name: [98] }))],
    ['a box that is turned', forged(block({ box: [1, ...[2, 0, 0, 1, 2, 3].flatMap((x) => f64(x))] }))],
    ['a mark of 2', forged(block({ box: [2] }))],
    ['an area that is no number', forged(block({ area: NaN }))],
    ['a number that is not finite', forged(block({ value: [1, ...f64(Infinity)] }))],
    ['a boolean of 2', forged(block({ value: [1, 2] }), { type: 1 })],
    ['a text that is no UTF-8', forged(block({ value: [1, ...texts([0xff])] }), { type: 2 })],
    ['a text longer than its block', forged(block({ value: [1, ...u32(2 ** 31)] }), { type: 3 })],
    ['bytes behind the last column', forged([...block(), 0])],
    ['a block that ends early', forged(block().slice(0, -1))],
    ['no objects', forged(block(), { count: 0 })],
    ['more objects than a block has', forged(block(), { count: 257 })],
    ['an unknown type', forged(block(), { type: 4 })],
    ['another property', forged(block(), { name: 'q' })],
    ['a key that is too long', forged(block({ name: Array<number>(300).fill(97) }), { key: Array<number>(300).fill(97) })],
  ])('%s is refused', async (_, table) => {
    await expect(table.row(0)).rejects.toBeInstanceOf(HierarchyProblem);
  });
});

describe('a table that tests write', () => {
  it('is read as they mean it', async () => {
    const rows = Array.from({ length: 700 }, (_, i) => ({ name: `wall ${String(i).padStart(3, '0')}`, values: [i, i % 2 === 0, `text ${i}`, null], box: i % 3 ? null : { min: [0, 0, i] as const, max: [1, 1, i + 1] as const }, triangles: i, area: i / 2 }));
    const { bytes, json } = tableOfRows(rows, TABLE_JSON.properties);
    const { table } = tableOf(bytes, { json });
    expect(await table.rows({ begin: 0, end: 700 })).toEqual(rows.map((row, object) => ({ object, ...row })));
  });
});

describe('names that fit', () => {
  const tableOfNames = (names: readonly string[]): ObjectTable => {
    const { bytes, json } = tableOfRows([...names].sort().map((name) => ({ name, values: [], box: null, triangles: 0, area: 0 })), []);
    return tableOf(bytes, { json }).table;
  };
  const found = async (table: ObjectTable, text: string, most = 8): Promise<string[]> => (await fittingNames(table, text, most)).rows.map(({ name }) => name);

  it('begin so, however their letters are written, before those that have it elsewhere', async () => {
    const table = tableOfNames(['', 'Main Street 1', 'Main Street 12', 'MAIN', 'main', 'East Main Road', 'Old main st', 'Park']);
    expect(await found(table, 'main')).toEqual(['main', 'Main Street 1', 'Main Street 12', 'MAIN', 'East Main Road', 'Old main st']);
    expect(await found(table, 'main str')).toEqual(['Main Street 1', 'Main Street 12']);
    expect(await found(table, 'road EAST')).toEqual(['East Main Road']);
    expect(await found(table, 'm', 2)).toEqual(['main', 'MAIN']);
    expect(await found(table, '  ')).toEqual([]);
    expect(await found(table, 'x')).toEqual([]);
  });

  it('of a large table are those that begin so', async () => {
    const table = tableOfNames(Array.from({ length: 2 ** 14 + 1 }, (_, i) => `Wall ${String(i).padStart(5, '0')}`));
    expect(await found(table, 'wall 123', 2)).toEqual(['Wall 12300', 'Wall 12301']);
    expect(await found(table, '12300')).toEqual([]);
  });
});

describe('bytes', () => {
  it('are compared as the program does', () => {
    const sorted = ['', 'a', 'aa', 'b', '\u00e9', '\uffff', '\u{1f3e0}'].map((text) => new TextEncoder().encode(text));
    for (let i = 0; i < sorted.length; ++i) for (let k = 0; k < sorted.length; ++k) expect(Math.sign(compareBytes(sorted[i], sorted[k]))).toBe(Math.sign(i - k));
  });
});
