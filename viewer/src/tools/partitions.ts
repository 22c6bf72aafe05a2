// SPDX-License-Identifier: MIT
// The partitions below a node, as far as they are wanted: what tools that measure the original mesh go through.
import type { TileRecord } from '../hierarchy/tile_index.js';
import type { Node } from '../hierarchy/tree.js';
import type { TileSource } from '../scene/surface.js';

const PAGE_WAIT = 50; // milliseconds between two looks for a page of the index

export const ROOT: Node = { level: 0, index: 0 };

export interface Recorded {
  readonly node: Node;
  readonly record: TileRecord;
}

/// As soon as its page of the index is there; null of a damaged one.
export async function recordOf({ index }: TileSource, node: Node, signal: AbortSignal): Promise<TileRecord | null> {
  for (;;) {
    const record = index.record(node);
    if (record !== null || index.isLost(node)) return record;
    await new Promise((resolve) => setTimeout(resolve, PAGE_WAIT));
    signal.throwIfAborted();
  }
}

/// In their order. `wanted`: whether anything within a record's box is. Rejects with Error where the index is damaged, and when the signal aborts.
export async function partitionsOf(source: TileSource, wanted: (record: TileRecord) => boolean, signal: AbortSignal): Promise<Recorded[]> {
  const found: Recorded[] = [];
  const visit = async (node: Node): Promise<void> => {
    const record = await recordOf(source, node, signal);
    if (record === null) throw new Error('a page of the index is damaged');
    if (!wanted(record)) return;
    if (node.level === source.tree.lastLevel) found.push({ node, record });
    else for (const child of source.tree.children(node)) await visit(child);
  };
  await visit(ROOT);
  return found;
}
