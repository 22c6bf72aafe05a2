// SPDX-License-Identifier: MIT
// The tree of a hierarchy: all of it follows from the number of partitions (docs/file_format.md, section 1).

/// A node with a tile: level, and number in its level (on the last level: the partition's).
export interface Node {
  readonly level: number;
  readonly index: number;
}

/// Tells nodes apart in maps. Levels are at most 32, indices below 2^32: exact in a double.
export function keyOf(level: number, index: number): number {
  return level * 2 ** 32 + index;
}

export class Tree {
  /// D: where the partitions are.
  readonly lastLevel: number;
  readonly tileCount: number;

  /// `partitions`: 1 … 2^32 - 1.
  constructor(readonly partitions: number) {
    this.lastLevel = Math.ceil(Math.log2(partitions));
    this.tileCount = 2 * partitions - 1;
  }

  /// First partition of a node above the last level, and the one after its last. O(level).
  range(level: number, index: number): [number, number] {
    let first = 0;
    let last = this.partitions;
    for (let bit = level - 1; bit >= 0; --bit) {
      const middle = first + Math.ceil((last - first) / 2);
      if (Math.floor(index / 2 ** bit) % 2 === 0) last = middle;
      else first = middle;
    }
    return [first, last];
  }

  /// The node on the level above the last that holds a partition. O(level).
  private above(partition: number): number {
    let first = 0;
    let last = this.partitions;
    let index = 0;
    for (let level = 0; level < this.lastLevel - 1; ++level) {
      const middle = first + Math.ceil((last - first) / 2);
      const right = partition >= middle;
      if (right) first = middle;
      else last = middle;
      index = 2 * index + (right ? 1 : 0);
    }
    return index;
  }

  /// Number of the node's ancestor on `ancestorLevel` <= its own.
  ancestor(level: number, index: number, ancestorLevel: number): number {
    if (level === ancestorLevel) return index;
    if (level < this.lastLevel) return Math.floor(index / 2 ** (level - ancestorLevel));
    return Math.floor(this.above(index) / 2 ** (level - 1 - ancestorLevel));
  }

  /// Level of the deepest node that holds both nodes of `level`.
  commonLevel(level: number, one: number, other: number): number {
    if (one === other) return level;
    let common = level - 1;
    let a = this.ancestor(level, one, common);
    let b = this.ancestor(level, other, common);
    for (; a !== b; --common) {
      a = Math.floor(a / 2);
      b = Math.floor(b / 2);
    }
    return common;
  }

  /// The tiles right below a tile: two, or none of a partition. An early node's is its partition.
  children({ level, index }: Node): Node[] {
    if (level === this.lastLevel) return [];
    if (level === this.lastLevel - 1) {
      const [first] = this.range(level, index);
      return [first, first + 1].map((partition) => ({ level: level + 1, index: partition }));
    }
    return [2 * index, 2 * index + 1].map((child) => this.tileNode(level + 1, child));
  }

  private tileNode(level: number, index: number): Node {
    if (level < this.lastLevel - 1) return { level, index };
    const [first, last] = this.range(level, index);
    return last - first === 1 ? { level: this.lastLevel, index: first } : { level, index };
  }

  /// The tile right above; null of the root.
  parent({ level, index }: Node): Node | null {
    if (level === 0) return null;
    const above = { level: level - 1, index: this.ancestor(level, index, level - 1) };
    if (level < this.lastLevel) return above;
    const [first, last] = this.range(above.level, above.index);
    return last - first > 1 || level === 1 ? above : { level: level - 2, index: Math.floor(above.index / 2) };
  }

  /// Number of the tile's record in the index. O(level).
  record({ level, index }: Node): number {
    if (level === this.lastLevel) return this.partitions - 1 + index;
    const before = 2 ** level - 1 + index;
    if (level < this.lastLevel - 1) return before;
    // Nodes of this level hold one partition (early: no record) or two.
    const [first] = this.range(level, index);
    return before - (2 * index - first);
  }
}

/// More tiles of a level are in several directories.
export const TILES_A_DIRECTORY = 10_000;

/// Returns the path of a tile's file, relative to the hierarchy.
export function tilePath({ level, index }: Node): string {
  const digits = (count: number) => String(count).padStart(6, '0');
  const first = index - (index % TILES_A_DIRECTORY);
  const directory = first === 0 ? '' : `${digits(first)}/`;
  return `tiles/${String(level).padStart(2, '0')}/${directory}${digits(index)}.glb`;
}
