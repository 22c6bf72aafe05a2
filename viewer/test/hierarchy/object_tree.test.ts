// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { compareBytes } from '../../src/hierarchy/byte_columns.js';
import { readObjectFacts } from '../../src/hierarchy/object_facts.js';
import { ObjectTable } from '../../src/hierarchy/object_table.js';
import { boxOfRange, childrenOf, rootOf, type ObjectNode } from '../../src/hierarchy/object_tree.js';
import { JsonValue } from '../../src/json_value.js';
import { tableOfRows, type NewRow } from '../support/object_table.js';
import { random } from '../support/random.js';

interface Counted { readonly table: ObjectTable; readonly asked: () => number }

/// A table of such names, behind a host that counts what it is asked for.
function tableOf(names: readonly string[]): Counted & { readonly rows: readonly NewRow[] } {
  const encoder = new TextEncoder();
  const sorted = [...new Set(names)].map((name) => ({ name, bytes: encoder.encode(name) })).sort((a, b) => compareBytes(a.bytes, b.bytes));
  const rows = sorted.map(({ name }, i): NewRow => ({ name, values: [i], box: { min: [i, 0, 0], max: [i + 1, 1, 1] }, triangles: 1, area: 1 }));
  const { bytes, json } = tableOfRows(rows, [{ name: 'n', type: 'number' }]);
  let asked = 0;
  const facts = readObjectFacts(JsonValue.parse(JSON.stringify(json), (what) => { throw new Error(what); }));
  const table = new ObjectTable(facts, (first, end) => {
    ++asked;
    return Promise.resolve(bytes.slice(first, end));
  });
  return { table, asked: () => asked, rows };
}

/// The children of a level, as one finds them who reads all names.
function expected(rows: readonly NewRow[], { text, begin, end }: ObjectNode): [string, number, number][] {
  const children: [string, number, number][] = [];
  for (let i = begin; i < end; ++i) {
    const slash = rows[i].name.indexOf('/', text.length);
    const child = slash < 0 ? rows[i].name : rows[i].name.slice(0, slash + 1);
    if (children.at(-1)?.[0] === child) children.at(-1)![2] = i + 1;
    else children.push([child, i, i + 1]);
  }
  return children;
}

/// The children of a level without its groups, each of which must be whole.
async function withoutGroups(table: ObjectTable, node: ObjectNode): Promise<ObjectNode[]> {
  const children = await childrenOf(table, node);
  expect(children.length).toBeLessThanOrEqual(64 * 256 + 512);
  expect([children[0].begin, children.at(-1)!.end]).toEqual([node.begin, node.end]);
  for (let i = 1; i < children.length; ++i) expect(children[i].begin).toBe(children[i - 1].end);
  const all = await Promise.all(children.map(async (child) => (child.kind === 'group' ? withoutGroups(table, child) : [child])));
  return all.flat();
}

async function check(table: ObjectTable, rows: readonly NewRow[], node: ObjectNode): Promise<number> {
  const children = await withoutGroups(table, node);
  expect(children.map(({ text, begin, end }) => [text, begin, end])).toEqual(expected(rows, node));
  let checked = 1;
  for (const child of children) if (child.kind === 'branch') checked += await check(table, rows, child);
  return checked;
}

function padded(number: number, digits: number): string {
  return String(number).padStart(digits, '0');
}

describe('a tree of names', () => {
  it('has each level as it is, whatever the names', async () => {
    const part = random(7);
    const below = (most: number): number => Math.floor(part() * most);
    const parts = ['a', 'b', '', '<b>', 'Straße', '\u{1f3e0}', 'غرفة', 'x'.repeat(90), '!', '~', 'a b', '部屋'];
    for (let round = 0; round < 6; ++round) {
      const names = Array.from({ length: 300 + 400 * round }, () => Array.from({ length: 1 + below(4) }, () => parts[below(parts.length)] + (below(3) === 0 ? String(below(40 * round + 1)) : '')).join('/'));
      const { table, rows } = tableOf(names.filter((name) => new TextEncoder().encode(name).length < 256));
      expect(await check(table, rows, rootOf(table))).toBeGreaterThan(3);
    }
  });

  it('reads a block for each child that spans blocks', async () => {
    const { table, asked } = tableOf(Array.from({ length: 20_000 }, (_, i) => `storey ${Math.floor(i / 5_000)}/room ${padded(Math.floor(i / 100), 3)}/wall ${padded(i, 5)}`));
    const storeys = await childrenOf(table, rootOf(table));
    expect(storeys.map(({ kind, label, begin, end }) => [kind, label, end - begin])).toEqual([0, 1, 2, 3].map((i) => ['branch', `storey ${i}`, 5_000]));
    expect(asked()).toBeLessThan(8);
    const rooms = await childrenOf(table, storeys[2]);
    expect([rooms.length, rooms[7].text]).toEqual([50, 'storey 2/room 107/']);
  });

  it('cuts a level of many into groups, of which each is as long as one can look at', async () => {
    const { table, asked, rows } = tableOf(Array.from({ length: 40_000 }, (_, i) => `city/building ${padded(i, 6)}`));
    const [city] = await childrenOf(table, rootOf(table));
    const groups = await childrenOf(table, city);
    expect(groups.length).toBeLessThanOrEqual(64);
    expect(groups.every(({ kind }) => kind === 'group')).toBe(true);
    const inner = await childrenOf(table, groups[2]);
    expect(inner.length).toBeLessThanOrEqual(512);
    const before = asked();
    expect(before).toBeLessThan(12);
    expect((await withoutGroups(table, city)).map(({ text }) => text)).toEqual(rows.map(({ name }) => name));
  });

  it('cuts no branch in two', async () => {
    const { table, rows } = tableOf(Array.from({ length: 30_000 }, (_, i) => `street ${padded(Math.floor(i / 30), 4)}/house ${padded(i % 30, 2)}`));
    const groups = await childrenOf(table, rootOf(table));
    expect(groups[0].kind).toBe('group');
    expect(groups.every(({ begin }) => begin % 30 === 0)).toBe(true);
    expect(await check(table, rows, rootOf(table))).toBe(1001);
  });

  it('knows where a branch lies', async () => {
    const { table, rows } = tableOf(Array.from({ length: 20_000 }, (_, i) => `b/${padded(i, 5)}`));
    expect(await boxOfRange(table, { begin: 3, end: 700 })).toEqual({ min: [3, 0, 0], max: [700, 1, 1] });
    expect(await boxOfRange(table, { begin: 5, end: 6 })).toEqual(rows[5].box);
    const { min, max } = (await boxOfRange(table, { begin: 0, end: 20_000 }))!;
    expect([min[0], max[0] > 19_000]).toEqual([0, true]);
  });
});

describe('a column of a table', () => {
  it('has the values of one property, in order, from few requests', async () => {
    const { table, asked } = tableOf(Array.from({ length: 20_000 }, (_, i) => `n ${padded(i, 5)}`));
    const values: unknown[] = [];
    for await (const part of table.column(0)) {
      expect(part.first).toBe(values.length);
      values.push(...part.values);
    }
    expect(values).toEqual(Array.from({ length: 20_000 }, (_, i) => i));
    expect(asked()).toBeLessThan(6);
  });
});
