// SPDX-License-Identifier: MIT
// Objects as a tree of their names, where "/" parts them: "storey/room/wall".
//
// Problem: a level may have a million children, and no list of them stands anywhere.
// Idea: names ascend, so a branch is a range of objects, and each child of a level another one within it. The directory has the first name of each
// block of 256 objects. Where two blocks that follow each other begin in one child, all between is that child; where they do not, the first of the two
// has the borders. So a level costs one block for each of its children that a block begins with, not for each object:
//
//     blocks   |a/..     |a/..     |b/..     |f/..     |
//     children  a a a a a a a a a b b b b c d e f f f f     read: the 2nd (a | b), the 3rd (b | c d e | f) and the last
//
// A level with more children than one can look at becomes groups of neighbours, cut where blocks begin, each a level of its own.
// Cost: at most 64 blocks a level, which are fetched together.
import type { ObjectRange, ObjectTable } from './object_table.js';
import type { ObjectBox } from './object_blocks.js';

/// A level with more starts of blocks is not read, but cut into groups.
const MOST_BLOCKS = 64;
/// A level with more children is.
const MOST_CHILDREN = 512;
const BLOCK_OBJECTS = 256; // at the most
const SAMPLE = 16; // objects

/// Objects that stand together in a tree. A `group` has no name: its label is that of the first in it.
export interface ObjectNode extends ObjectRange {
  readonly kind: 'object' | 'branch' | 'group';
  /// An object's name; what all names of a branch begin with, "/" included; of a group what those of its level begin with.
  readonly text: string;
  /// The last part of the text.
  readonly label: string;
}

interface Child {
  readonly text: string;
  readonly label: string;
  readonly isBranch: boolean;
}

/// The child of a level that a name belongs to. `prefix`: with what the level's names begin.
function childOf(name: string, prefix: string): Child {
  const slash = name.indexOf('/', prefix.length);
  if (slash < 0) return { text: name, label: name.slice(prefix.length) || name, isBranch: false };
  return { text: name.slice(0, slash + 1), label: name.slice(prefix.length, slash) || '/', isBranch: true };
}

/// The first object at which a block begins in a child, and the last one; the level's first object counts as one.
interface Mark {
  readonly child: Child;
  readonly first: number;
  last: number;
}

async function marksOf(table: ObjectTable, range: ObjectRange, prefix: string): Promise<Mark[]> {
  const marks: Mark[] = [];
  const add = (object: number, name: string): void => {
    const child = childOf(name, prefix);
    const before = marks.at(-1);
    if (before?.child.text === child.text) before.last = object;
    else marks.push({ child, first: object, last: object });
  };
  add(range.begin, (await table.row(range.begin)).name);
  for (const { object, beginning, isWhole } of await table.starts(range)) {
    add(object, isWhole || beginning.includes('/', prefix.length) ? beginning : (await table.row(object)).name);
  }
  return marks;
}

function nodeOf({ text, label, isBranch }: Child, begin: number, end: number): ObjectNode {
  return { kind: isBranch ? 'branch' : 'object', text, label, begin, end };
}

/// All children, each with the range of its objects.
async function listed(table: ObjectTable, { end }: ObjectRange, prefix: string, marks: readonly Mark[]): Promise<ObjectNode[]> {
  const rows = await Promise.all(marks.map(({ last }, i) => table.rows({ begin: last, end: marks.at(i + 1)?.first ?? end })));
  const begun: { child: Child; first: number }[] = [];
  const add = (child: Child, first: number): void => {
    if (begun.at(-1)?.child.text !== child.text) begun.push({ child, first });
  };
  marks.forEach(({ child, first }, i) => {
    add(child, first);
    for (const { object, name } of rows[i]) add(childOf(name, prefix), object);
  });
  return begun.map(({ child, first }, i) => nodeOf(child, first, begun.at(i + 1)?.first ?? end));
}

/// Where the child of a mark begins: perhaps in the block ahead of it.
async function beginOf(table: ObjectTable, prefix: string, before: Mark, { child, first }: Mark): Promise<number> {
  if (!child.isBranch) return first;
  const rows = await table.rows({ begin: before.last, end: first });
  return rows.find(({ name }) => childOf(name, prefix).text === child.text)?.object ?? first;
}

async function grouped(table: ObjectTable, { begin, end }: ObjectRange, prefix: string, marks: readonly Mark[]): Promise<ObjectNode[]> {
  const size = Math.ceil(marks.length / MOST_BLOCKS);
  const starts = marks.map((_, i) => i).filter((i) => i % size === 0);
  const begins = await Promise.all(starts.map(async (i) => (i === 0 ? begin : beginOf(table, prefix, marks[i - 1], marks[i]))));
  return starts.map((i, k): ObjectNode => ({ kind: 'group', text: prefix, label: marks[i].child.label, begin: begins[k], end: begins.at(k + 1) ?? end }));
}

function isLong(marks: readonly Mark[]): boolean {
  const most = marks.reduce((sum, { child }) => sum + (child.isBranch ? 1 : BLOCK_OBJECTS), 0);
  return marks.length > 2 && (marks.length > MOST_BLOCKS || most > MOST_CHILDREN);
}

/// The children of a branch or a group, in the order of their names. Rejects as the table does.
export async function childrenOf(table: ObjectTable, node: Pick<ObjectNode, 'text' | 'begin' | 'end'>): Promise<ObjectNode[]> {
  if (node.begin >= node.end) return [];
  const marks = await marksOf(table, node, node.text);
  return isLong(marks) ? grouped(table, node, node.text, marks) : listed(table, node, node.text, marks);
}

/// All of a table.
export function rootOf({ count }: ObjectTable): ObjectNode {
  return { kind: 'branch', text: '', label: '', begin: 0, end: count };
}

function commonBox(boxes: readonly ObjectBox[]): ObjectBox | null {
  const along = (side: 'min' | 'max', axis: number): number => boxes.reduce((all, box) => Math[side](all, box[side][axis]), side === 'min' ? Infinity : -Infinity);
  const corner = (side: 'min' | 'max'): ObjectBox['min'] => [along(side, 0), along(side, 1), along(side, 2)];
  return boxes.length === 0 ? null : { min: corner('min'), max: corner('max') };
}

/// The box of a range of objects; of more than 64 blocks that of some at 64 places, evenly along it. Null: it has none.
export async function boxOfRange(table: ObjectTable, { begin, end }: ObjectRange): Promise<ObjectBox | null> {
  const step = (end - begin) / MOST_BLOCKS;
  const most = step > BLOCK_OBJECTS ? SAMPLE : Math.ceil(step);
  const places = Array.from({ length: MOST_BLOCKS }, (_, i) => begin + Math.floor(step * i));
  const rows = await Promise.all(places.map((place) => table.rows({ begin: place, end: Math.min(end, place + most) })));
  return commonBox(rows.flat().flatMap(({ box }) => box ?? []));
}
