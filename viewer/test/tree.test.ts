// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { Tree, keyOf, tilePath, type Node } from '../src/hierarchy/tree.js';

/// All tiles in the order of the index, made by walking the definition.
function tiles({ partitions, lastLevel }: Tree): Node[] {
  const found: Node[] = [];
  const walk = (level: number, index: number, first: number, last: number): void => {
    if (last - first === 1) {
      found.push({ level: lastLevel, index: first });
      return;
    }
    found.push({ level, index });
    const middle = first + Math.ceil((last - first) / 2);
    walk(level + 1, 2 * index, first, middle);
    walk(level + 1, 2 * index + 1, middle, last);
  };
  walk(0, 0, 0, partitions);
  return found.sort((a, b) => keyOf(a.level, a.index) - keyOf(b.level, b.index));
}

const SIZES = [1, 2, 3, 4, 5, 6, 7, 8, 9, 13, 16, 17, 31, 32, 33, 100, 353];

describe('Tree', () => {
  it.each(SIZES)('numbers the records of %i partitions in order', (partitions) => {
    const tree = new Tree(partitions);
    expect(tiles(tree).map((node) => tree.record(node))).toEqual([...Array(tree.tileCount).keys()]);
  });

  it.each(SIZES)('has each tile of %i partitions but the root as a child of its parent', (partitions) => {
    const tree = new Tree(partitions);
    const all = tiles(tree);
    const below = all.flatMap((node) => tree.children(node).map((child) => ({ child, node })));
    expect(below).toHaveLength(all.length - 1);
    for (const { child, node } of below) expect(tree.parent(child)).toEqual(node);
  });

  it('knows ancestors of the partition below an early node', () => {
    const tree = new Tree(3);
    expect(tree.ancestor(2, 2, 1)).toBe(1);
    expect(tree.parent({ level: 2, index: 2 })).toEqual({ level: 0, index: 0 });
    expect(tree.commonLevel(2, 0, 1)).toBe(1);
    expect(tree.commonLevel(2, 1, 2)).toBe(0);
  });

  it('holds keys of the largest hierarchies apart', () => {
    const keys = [keyOf(32, 2 ** 32 - 2), keyOf(32, 2 ** 32 - 3), keyOf(31, 2 ** 32 - 2)];
    expect(new Set(keys).size).toBe(keys.length);
    expect(keys.every(Number.isSafeInteger)).toBe(true);
    expect(tilePath({ level: 3, index: 7 })).toBe('tiles/03/000007.glb');
    expect(tilePath({ level: 14, index: 9_999 })).toBe('tiles/14/009999.glb');
    expect(tilePath({ level: 14, index: 10_000 })).toBe('tiles/14/010000/010000.glb');
    expect(tilePath({ level: 21, index: 1_234_567 })).toBe('tiles/21/1230000/1234567.glb');
  });
});
