// SPDX-License-Identifier: MIT
// Which cut a view asks for: from the root down, always what has the largest error on screen is refined next, as long as
// there is room (the distribution by distance and error of Zunino et al., "Level of detail based on frame rate").
import type { TileRecord } from '../hierarchy/tile_index.js';
import { keyOf, type Node, type Tree } from '../hierarchy/tree.js';
import { PriorityQueue } from './priority_queue.js';
import { isInView, pixelsOf, squarePixels, type Viewpoint } from './viewpoint.js';

export interface Limits {
  /// Error on screen, in pixels, up to which a tile will do.
  readonly threshold: number;
  /// The same of tiles that may be finer, as long as their triangles are larger than a pixel; if it is less.
  readonly fine: number;
  /// The vertices of all tiles in view.
  readonly vertices: number;
  /// The level of the finest tiles.
  readonly mostLevel: number;
  /// The bytes of all tiles of the cut and above it, in memory, with room for the largest of them on its way.
  readonly bytes: number;
}

export interface Sources {
  readonly tree: Tree;
  /// null: not known yet.
  readonly record: (node: Node) => TileRecord | null;
  readonly bytesOf: (record: TileRecord, node: Node) => number;
  /// Tells whether nothing of the node can be seen although it is in view.
  readonly isHidden: (key: number, record: TileRecord) => boolean;
  /// Tells whether a tile, or its record, could not be had: the one above stands for it.
  readonly isLost: (node: Node) => boolean;
  /// Tells whether the node was refined in the last cut, and is to stay so for a while.
  readonly wasRefined: (key: number) => boolean;
  /// Tells whether the node may be finer than the threshold.
  readonly mayBeFine: (key: number) => boolean;
}

export interface ChosenNode {
  readonly node: Node;
  readonly key: number;
  readonly record: TileRecord;
  readonly inView: boolean;
  /// Error on screen, in pixels; 0 where nothing can be seen.
  readonly pixels: number;
  readonly children: ChosenNode[];
}

export interface Choice {
  /// null: even the root is not known yet.
  readonly root: ChosenNode | null;
  /// Those with children, in the order in which they deserved them.
  readonly refined: readonly ChosenNode[];
  /// Room, not the threshold, was the end of it.
  readonly limited: { readonly vertices: boolean; readonly bytes: boolean };
  /// The bytes of all its tiles, and of those above them, with room for the largest of them on its way.
  readonly bytes: number;
  /// Records are missing: ask again when they have come.
  readonly incomplete: boolean;
}

/// A tile that is shown finer stays so until its error is this much smaller than what refines it, or another one's this
/// much larger: no flicker.
const HYSTERESIS = 1.3;
/// A tile takes so many times its bytes on its way: its file, packed and unpacked, is in memory as well until it is decoded.
export const LOADING = 2;

/// Two triangles make up a square.
function trianglePixels(view: Viewpoint, record: TileRecord): number {
  return squarePixels(view, record, Math.max(1, record.interior + record.border) / 2);
}

class Chooser {
  readonly refined: ChosenNode[] = [];
  readonly limited = { vertices: false, bytes: false };
  incomplete = false;
  private readonly queue = new PriorityQueue<ChosenNode>();
  private vertices = 0;
  private held = 0;
  private largest = 0;

  constructor(
    private readonly sources: Sources,
    private readonly view: Viewpoint,
    private readonly limits: Limits,
  ) {}

  /// null if the node's record is not there.
  private see(node: Node): ChosenNode | null {
    const record = this.sources.record(node);
    if (record === null) return null;
    const key = keyOf(node.level, node.index);
    const inView = isInView(this.view, record);
    const visible = inView && record.error > 0 && !this.sources.isHidden(key, record);
    const pixels = visible ? pixelsOf(this.view, record, record.error) : 0;
    return { node, key, record, inView, pixels, children: [] };
  }

  private add(chosen: ChosenNode): void {
    if (chosen.inView) this.vertices += chosen.record.own;
    const bytes = this.sources.bytesOf(chosen.record, chosen.node);
    this.held += bytes;
    this.largest = Math.max(this.largest, bytes);
    if (chosen.node.level >= this.limits.mostLevel) return;
    const deserved = chosen.pixels * (this.sources.wasRefined(chosen.key) ? HYSTERESIS : 1);
    if (deserved > this.allowed(chosen)) this.queue.push(chosen, deserved);
  }

  private allowed({ key, record }: ChosenNode): number {
    const { threshold, fine } = this.limits;
    return fine < threshold && this.sources.mayBeFine(key) && trianglePixels(this.view, record) > 1 ? fine : threshold;
  }

  private refine(chosen: ChosenNode): void {
    const nodes = this.sources.tree.children(chosen.node);
    if (nodes.some((child) => this.sources.isLost(child))) return; // nothing need be known of them
    const children = nodes.map((child) => this.see(child));
    if (nodes.some((child) => this.sources.isLost(child))) return;
    if (!children.every((child) => child !== null)) {
      this.incomplete = true;
      return;
    }
    if (!this.hasRoom(chosen, children)) return;
    this.vertices -= chosen.inView ? chosen.record.own : 0;
    chosen.children.push(...children);
    this.refined.push(chosen);
    for (const child of children) this.add(child);
  }

  private hasRoom(chosen: ChosenNode, children: readonly ChosenNode[]): boolean {
    let vertices = this.vertices - (chosen.inView ? chosen.record.own : 0);
    let { held: bytes, largest } = this;
    for (const { inView, record, node } of children) {
      const each = this.sources.bytesOf(record, node);
      vertices += inView ? record.own : 0;
      bytes += each;
      largest = Math.max(largest, each);
    }
    bytes += LOADING * largest;
    if (vertices > this.limits.vertices) this.limited.vertices = true;
    if (bytes > this.limits.bytes) this.limited.bytes = true;
    return vertices <= this.limits.vertices && bytes <= this.limits.bytes;
  }

  get bytes(): number {
    return this.held + LOADING * this.largest;
  }

  choose(): ChosenNode | null {
    const root = this.see({ level: 0, index: 0 });
    if (root === null) {
      this.incomplete = true;
      return null;
    }
    this.add(root);
    for (let next = this.queue.pop(); next !== undefined; next = this.queue.pop()) this.refine(next);
    return root;
  }
}

/// O(n log n) of the nodes chosen; nothing else of the tree is looked at.
export function chooseCut(sources: Sources, view: Viewpoint, limits: Limits): Choice {
  const chooser = new Chooser(sources, view, limits);
  const root = chooser.choose();
  return { root, refined: chooser.refined, limited: chooser.limited, bytes: chooser.bytes, incomplete: chooser.incomplete };
}
