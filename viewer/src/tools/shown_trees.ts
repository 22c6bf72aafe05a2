// SPDX-License-Identifier: MIT
// Trees of the interior triangles of tiles that were asked about, while they are drawn and fit.
import type { Tile } from '../hierarchy/tile.js';
import type { DrawnTile } from '../scene/surface.js';
import { TriangleTree } from './triangle_tree.js';

export class ShownTrees {
  private readonly trees = new Map<Tile, TriangleTree>();
  private usedBytes = 0;

  constructor(private readonly mostBytes = 32e6) {}

  get bytes(): number {
    return this.usedBytes;
  }

  of(tile: Tile): TriangleTree {
    const known = this.trees.get(tile);
    if (known) return known;
    const tree = new TriangleTree(tile.positions, tile.indices, tile.interiorCount);
    for (const each of this.trees.keys()) if (this.usedBytes + tree.bytes > this.mostBytes) this.forget(each);
    this.trees.set(tile, tree);
    this.usedBytes += tree.bytes;
    return tree;
  }

  forgetAllBut(surface: readonly DrawnTile[]): void {
    const drawn = new Set(surface.map(({ tile }) => tile));
    for (const tile of this.trees.keys()) if (!drawn.has(tile)) this.forget(tile);
  }

  private forget(tile: Tile): void {
    this.usedBytes -= this.trees.get(tile)?.bytes ?? 0;
    this.trees.delete(tile);
  }
}
