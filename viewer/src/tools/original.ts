// SPDX-License-Identifier: MIT
// The point of the original mesh that a ray meets first: down the tree, always where the ray enters next, to partitions
// that are asked for, looked at, and let go.
import { PriorityQueue } from '../cut/priority_queue.js';
import { letGo } from '../hierarchy/let_go.js';
import type { TileRecord } from '../hierarchy/tile_index.js';
import type { Node } from '../hierarchy/tree.js';
import type { TileSource } from '../scene/surface.js';
import { recordOf, ROOT } from './partitions.js';
import { Search, type Hit, type Keeps } from './pick.js';
import { RayProbe, type Ray, type TriangleProbe } from './ray.js';

export interface OriginalOptions {
  readonly signal: AbortSignal;
  readonly keeps?: Keeps;
  /// Partitions that are asked for at the most.
  readonly mostTiles?: number;
}

const MOST_TILES = 64;

interface Met {
  readonly node: Node;
  readonly record: TileRecord;
  readonly entry: number;
}

class Descent {
  private readonly queue = new PriorityQueue<Met>();
  private readonly search: Search;
  private left: number;

  constructor(
    private readonly source: TileSource,
    probe: TriangleProbe,
    private readonly options: OriginalOptions,
  ) {
    this.search = new Search(probe, options.keeps);
    this.left = options.mostTiles ?? MOST_TILES;
  }

  async run(): Promise<Hit | null> {
    await this.meet(ROOT);
    for (let next = this.queue.pop(); next !== undefined && next.entry < this.search.limit; next = this.queue.pop()) {
      if (next.node.level < this.source.tree.lastLevel) for (const child of this.source.tree.children(next.node)) await this.meet(child);
      else if (this.left-- > 0) await this.lookInto(next);
      else return null; // what would be nearest is not known
    }
    return this.search.hit;
  }

  private async meet(node: Node): Promise<void> {
    const record = await recordOf(this.source, node, this.options.signal);
    if (record === null) return;
    const entry = this.search.probe.enters([...record.min, ...record.max]);
    if (entry < this.search.limit) this.queue.push({ node, record, entry }, -entry);
  }

  /// Border triangles too, with ghosts where their own tiles have them.
  private async lookInto({ node, record }: Met): Promise<void> {
    const tile = await this.source.load(node, record, this.options.signal);
    const { indices, interiorCount, border } = tile;
    for (let i = 0; i < 3 * interiorCount; i += 3) this.search.look(node, tile, [indices[i], indices[i + 1], indices[i + 2]]);
    for (let i = 0; i < border.length; i += 3) this.search.look(node, tile, [border[i], border[i + 1], border[i + 2]]);
    letGo(tile);
  }
}

/// Null: it meets nothing, or more tiles would be needed than are allowed. Rejects where a file cannot be had, and when the signal
/// aborts.
export function pickOriginal(source: TileSource, ray: Ray, options: OriginalOptions): Promise<Hit | null> {
  return findOriginal(source, new RayProbe(ray), options);
}

/// The same of whatever a probe looks for: as the nearest place to a point.
export function findOriginal(source: TileSource, probe: TriangleProbe, options: OriginalOptions): Promise<Hit | null> {
  return new Descent(source, probe, options).run();
}
