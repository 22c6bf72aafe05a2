// SPDX-License-Identifier: MIT
// The tiles in memory and on their way: a tree from the root down, within a budget of bytes.
import { Seam } from './seam.js';
import { HierarchyProblem } from '../hierarchy/problem.js';
import { letGo } from '../hierarchy/let_go.js';
import type { Tile } from '../hierarchy/tile.js';
import type { TileRecord } from '../hierarchy/tile_index.js';
import { keyOf, type Node, type Tree } from '../hierarchy/tree.js';

export interface ResidentTile {
  readonly node: Node;
  readonly key: number;
  readonly tile: Tile;
  readonly seam: Seam;
}

export interface Wanted {
  readonly node: Node;
  readonly record: TileRecord;
  /// The most memory that the tile takes while it is on its way: more than when it is there.
  readonly loadingBytes: number;
}

/// How tiles come, and what is told of them.
export interface StoreHost {
  load(node: Node, record: TileRecord, signal: AbortSignal): Promise<Tile>;
  bytesOf(tile: Tile, seam: Seam): number;
  /// A tile that is here cannot be drawn yet; if it is not said, all can. Once it can be drawn it stays so.
  awaits?(key: number): boolean;
  came(tile: ResidentTile): void;
  gone(tile: ResidentTile): void;
  failed(node: Node, problem: unknown): void;
}

interface TileEntry {
  readonly node: Node;
  readonly key: number;
  readonly parent: number | null;
  /// Bytes that are counted for it.
  bytes: number;
  resident: ResidentTile | null;
  readonly abort: AbortController;
  /// Children that are there or on their way.
  below: number;
  /// The number of the last request that named it, or drew it.
  useful: number;
}

/// A request that no view asks for any more goes on for a while: views come back.
const PATIENCE_MS = 300;
/// A file that failed is asked for again after this time, longer each time.
const RETRY_MS = 2000;
/// After so many times it is given up, for as long as this; for less where the host or the line was it, which may be back.
const MOST_TRIES = 4;
const FORGET_MS = 60_000;
const BACK_MS = 20_000;

interface Failure {
  tries: number;
  again: number;
  mayPass: boolean;
  /// It did not have to wait since another tile came.
  wasHurried: boolean;
}

export class TileStore {
  aborted = 0;
  evicted = 0;
  peakBytes = 0;
  usedBytes = 0;
  private readonly entries = new Map<number, TileEntry>();
  private readonly failures = new Map<number, Failure>();
  private loading = 0;
  private isOver = false;
  private isFrozen = false;

  constructor(
    private readonly host: StoreHost,
    private readonly tree: () => Tree,
    public budget: number,
    private readonly requests: number,
  ) {}

  /// Puts the root there: it never goes.
  addRoot(tile: Tile, tree: Tree): ResidentTile {
    const entry = this.enter({ level: 0, index: 0 }, 0, 0);
    const resident = this.arrive(entry, tile, tree);
    this.host.came(resident);
    return resident;
  }

  /// A tile that can be drawn.
  get(key: number): ResidentTile | undefined {
    if (this.host.awaits?.(key)) return undefined;
    return this.entries.get(key)?.resident ?? undefined;
  }

  has(key: number): boolean {
    return this.get(key) !== undefined;
  }

  get pending(): number {
    return this.loading;
  }

  *residents(): Iterable<ResidentTile> {
    for (const { resident } of this.entries.values()) if (resident) yield resident;
  }

  get residentCount(): number {
    return this.entries.size - this.loading;
  }

  /// Asks for tiles, most urgent first, each after those above it; aborts what was asked for and is no longer
  /// wanted. They are what must stay, and the root. Returns the number of those not there yet that will come.
  want(wanted: readonly Wanted[], now: number): number {
    for (const { node } of wanted) this.touch(node, now);
    if (this.isFrozen) return 0;
    this.abortStale(now);
    let missing = 0;
    let isFull = false;
    for (const each of wanted) {
      const key = keyOf(each.node.level, each.node.index);
      if (this.has(key) || this.isGivenUp(key, now)) continue;
      ++missing;
      if (this.entries.has(key) || isFull || this.loading >= this.requests || this.mustWait(key, now)) continue;
      isFull = !this.start(each, now);
    }
    return missing;
  }

  /// Counts all tiles anew: what a tile takes will be another number as soon as keepWithin() has made room.
  recount(): void {
    for (const entry of this.entries.values()) {
      if (!entry.resident) continue;
      const bytes = this.host.bytesOf(entry.resident.tile, entry.resident.seam);
      this.usedBytes += bytes - entry.bytes;
      entry.bytes = bytes;
    }
  }

  /// Nothing comes any more: what is there stays, and what is on its way is given up.
  freeze(): void {
    this.isFrozen = true;
    for (const entry of [...this.entries.values()]) if (!entry.resident && this.entries.has(entry.key)) this.cancel(entry);
  }

  /// When a file that was given up by a fault of the host or the line may be asked for again; Infinity: there is none.
  get nextTry(): number {
    const times = [...this.failures.values()].map(({ mayPass, again }) => (mayPass && !this.isFrozen ? again : Infinity));
    return Math.min(Infinity, ...times);
  }

  /// A file that failed too often, not long ago.
  isGivenUp(key: number, now: number): boolean {
    const failure = this.failures.get(key);
    if (failure === undefined || failure.tries < MOST_TRIES) return false;
    if (now < failure.again) return true;
    this.failures.delete(key);
    return false;
  }

  /// Ends a change of what is wanted, or of what tiles take: what is left is within the budget if the wanted is.
  keepWithin(now: number): void {
    this.makeRoom(0, now);
    this.count(0);
  }

  /// Drops least recently useful tiles until `bytes` more fit; false if what is left is useful at `now`.
  private makeRoom(bytes: number, now: number): boolean {
    if (this.usedBytes + bytes <= this.budget) return true;
    const candidates = [...this.entries.values()].filter((entry) => this.canGo(entry, now));
    candidates.sort((a, b) => a.useful - b.useful || b.key - a.key);
    for (const entry of candidates) {
      this.evict(entry);
      if (this.usedBytes + bytes <= this.budget) return true;
    }
    // Parents whose children went may go now.
    return candidates.length > 0 && this.makeRoom(bytes, now);
  }

  /// Drops what the host has lost a part of, and all below it: it comes again as it is wanted.
  dropLost(isLost: (tile: Tile) => boolean): void {
    for (const entry of [...this.entries.values()])
      if (this.entries.has(entry.key) && entry.resident !== null && isLost(entry.resident.tile)) this.drop(entry);
  }

  dispose(): void {
    this.isOver = true;
    for (const entry of this.entries.values()) entry.abort.abort();
    for (const resident of this.residents()) this.lose(resident);
    this.entries.clear();
  }

  /// It is of use at the time `now`.
  private touch({ level, index }: Node, now: number): void {
    const entry = this.entries.get(keyOf(level, index));
    if (entry) entry.useful = now;
  }

  private canGo(entry: TileEntry, now: number): boolean {
    return entry.resident !== null && entry.below === 0 && entry.useful < now && entry.parent !== null;
  }

  private count(bytes: number): void {
    this.usedBytes += bytes;
    this.peakBytes = Math.max(this.peakBytes, this.usedBytes);
  }

  private enter(node: Node, bytes: number, now: number): TileEntry {
    const key = keyOf(node.level, node.index);
    const above = node.level === 0 ? null : this.tree().parent(node);
    const parent = above ? keyOf(above.level, above.index) : null;
    const entry: TileEntry = { node, key, parent, bytes, resident: null, abort: new AbortController(), below: 0, useful: now };
    this.entries.set(key, entry);
    this.count(bytes);
    if (parent !== null) ++this.entries.get(parent)!.below;
    return entry;
  }

  private remove(entry: TileEntry): void {
    this.entries.delete(entry.key);
    this.count(-entry.bytes);
    const above = entry.parent === null ? undefined : this.entries.get(entry.parent);
    if (above) --above.below;
  }

  private evict(entry: TileEntry): void {
    this.remove(entry);
    ++this.evicted;
    if (entry.resident) this.lose(entry.resident);
  }

  private lose(resident: ResidentTile): void {
    this.host.gone(resident);
    letGo(resident.tile);
  }

  private start({ node, record, loadingBytes }: Wanted, now: number): boolean {
    const above = this.tree().parent(node);
    if (above && !this.entries.has(keyOf(above.level, above.index))) return true; // after the one above it
    if (!this.makeRoom(loadingBytes, now)) return false;
    const entry = this.enter(node, loadingBytes, now);
    ++this.loading;
    this.host.load(node, record, entry.abort.signal).then(
      (tile) => {
        this.finish(entry, tile);
      },
      (problem: unknown) => {
        this.fail(entry, problem);
      },
    );
    return true;
  }

  private finish(entry: TileEntry, tile: Tile): void {
    if (this.isOver || entry.abort.signal.aborted) {
      letGo(tile);
      return;
    }
    let resident: ResidentTile;
    try {
      resident = this.arrive(entry, tile, this.tree());
    } catch (problem) {
      letGo(tile);
      this.fail(entry, problem);
      return;
    }
    --this.loading;
    this.failures.delete(entry.key);
    this.hurry();
    this.host.came(resident);
  }

  private arrive(entry: TileEntry, tile: Tile, tree: Tree): ResidentTile {
    const seam = new Seam(tile, tree);
    const bytes = this.host.bytesOf(tile, seam);
    entry.resident = { node: entry.node, key: entry.key, tile, seam };
    this.count(bytes - entry.bytes);
    entry.bytes = bytes;
    return entry.resident;
  }

  private fail(entry: TileEntry, problem: unknown): void {
    if (this.isOver || entry.abort.signal.aborted) return;
    const { tries: before = 0, wasHurried = false } = this.failures.get(entry.key) ?? {};
    const tries = before + 1;
    const mayPass = problem instanceof HierarchyProblem && problem.mayPass;
    const pause = mayPass ? BACK_MS : FORGET_MS;
    const wait = tries < MOST_TRIES ? RETRY_MS * 2 ** (tries - 1) : pause;
    this.failures.set(entry.key, { tries, again: entry.useful + wait, mayPass, wasHurried });
    this.drop(entry);
    this.host.failed(entry.node, problem);
  }

  /// The host may be back: what failed by it waits no longer. Once, for it may be the file alone.
  private hurry(): void {
    for (const [key, failure] of this.failures)
      if (failure.mayPass && !failure.wasHurried) this.failures.set(key, { ...failure, again: 0, wasHurried: true });
  }

  /// Removes an entry and all below it.
  private drop(entry: TileEntry): void {
    for (const below of [...this.entries.values()].filter(({ parent }) => parent === entry.key)) this.cancel(below);
    if (entry.resident) {
      this.evict(entry);
      return;
    }
    --this.loading;
    this.remove(entry);
  }

  private cancel(entry: TileEntry): void {
    if (!entry.resident) ++this.aborted;
    entry.abort.abort();
    this.drop(entry);
  }

  private abortStale(now: number): void {
    for (const entry of [...this.entries.values()])
      if (!entry.resident && this.entries.has(entry.key) && entry.useful < now - PATIENCE_MS) this.cancel(entry);
  }

  /// Tiles that failed are asked for again as soon as they are wanted.
  retry(): void {
    this.failures.clear();
  }

  private mustWait(key: number, now: number): boolean {
    return now < (this.failures.get(key)?.again ?? 0);
  }
}

