// SPDX-License-Identifier: MIT
// The index, tiles.bin (docs/file_format.md, section 3), in pages: of a large one only those that are looked
// into are fetched.
import { archivedBytes } from './archive_format.js';
import { MOST_ELEMENTS, MOST_OWN, MOST_SIDE, mostSplits } from './limits.js';
import { HierarchyProblem } from './problem.js';
import type { FilePlace } from './files.js';
import { keyOf, tilePath, type Node, type Tree } from './tree.js';

type Corner = readonly [number, number, number];

export interface TileRecord {
  readonly own: number;
  readonly ghosts: number;
  readonly copies: number;
  readonly splits: number;
  readonly interior: number;
  readonly border: number;
  /// The texels of the tile's picture, and of its normal map; 0: it has neither.
  readonly pictureWidth: number;
  readonly pictureHeight: number;
  readonly hasNormalMap: boolean;
  /// Estimated distance to the input, in its units, and no less than a texel that is coarser than the input's; 0 of partitions.
  readonly error: number;
  /// No point of its surface is farther from the input's, and none of the input's from it: certain; of partitions what rounding did.
  readonly bound: number;
  /// Box of all of the input that the tile stands for, in the coordinates of decoded tiles: that of its vertices, larger by
  /// its bound.
  readonly min: Corner;
  readonly max: Corner;
  /// The length of the tile's file.
  readonly bytes: number;
  /// XXH3-64 of the tile's file.
  readonly checksum: bigint;
}

/// Bytes [first, end) of the index, or all of it where a host knows no ranges.
export type ReadRange = (first: number, end: number) => Promise<Uint8Array>;

const FILE = 'tiles.bin';
const MAGIC = 'MHTILES\n';
const VERSIONS = [4, 5]; // 5: some tiles have normal maps
const HEADER_BYTES = 32;
const RECORD_BYTES = 120;
const PAGE_RECORDS = 545; // a page is just below 64 KiB
/// A page that failed is asked for again after this time.
const RETRY_MS = 2000;

/// Bytes of the index of so many tiles.
export function indexSize(tiles: number): number {
  return HEADER_BYTES + tiles * RECORD_BYTES;
}

function nodeAt(view: DataView, at: number): Node {
  return { level: view.getUint32(at, true), index: view.getUint32(at + 4, true) };
}

function bytesAt(view: DataView, at: number): number {
  return Number(view.getBigUint64(at + 104, true));
}

/// The record of a page whose file those of the others follow: the root's lies elsewhere.
function firstOf(page: number): number {
  return page === 0 ? 1 : 0;
}

function readRecord(view: DataView, at: number, place: Corner): TileRecord {
  const u32 = (offset: number): number => view.getUint32(at + offset, true);
  const f32 = (offset: number): number => view.getFloat32(at + offset, true);
  const bound = f32(52);
  const corner = (offset: number, more: number): Corner =>
    [0, 1, 2].map((axis) => f32(offset + 4 * axis) - place[axis] + more) as unknown as Corner;
  return {
    own: u32(8),
    ghosts: u32(16),
    copies: u32(20),
    splits: u32(84),
    interior: u32(24),
    border: u32(28),
    pictureWidth: u32(88),
    pictureHeight: u32(92),
    hasNormalMap: u32(100) !== 0,
    error: f32(48),
    bound,
    min: corner(60, -bound),
    max: corner(72, bound),
    bytes: bytesAt(view, at),
    checksum: view.getBigUint64(at + 112, true),
  };
}

/// No more than the format allows: sizes are computed from these.
function isSound(record: TileRecord): boolean {
  const { own, ghosts, copies, splits, interior, border, pictureWidth, pictureHeight, min, max, error, bound } = record;
  const counts = own >= 1 && own <= MOST_OWN && [ghosts, copies, interior, border].every((count) => count <= MOST_ELEMENTS);
  const picture = pictureWidth <= MOST_SIDE && pictureHeight <= MOST_SIDE && (pictureWidth === 0) === (pictureHeight === 0);
  return counts && picture && splits <= mostSplits({ interior, border }) && error >= 0 && bound >= 0 && [...min, ...max, error, bound].every(Number.isFinite);
}

/// A page that is not there is on its way, or is asked for again later.
interface Absent {
  readonly again: number;
}

export class TileIndex {
  private readonly pages = new Map<number, DataView | Absent>();
  private readonly damaged = new Set<number>();
  private readonly distances = new Map<number, Float64Array>(); // by page

  /// `place`: what decoded tiles' positions are relative to, itself relative to the origin. `onPage` is called when a
  /// page has come, `onProblem` when one did not, or a record is damaged. `lacks`: tiles that will not come.
  constructor(
    private readonly tree: Tree,
    private readonly place: Corner,
    private readonly read: ReadRange,
    private readonly onPage: () => void,
    private readonly onProblem: (problem: unknown) => void,
    private readonly lacks: (node: Node) => boolean = () => false,
  ) {}

  /// Fetches the header and the first page; nothing else works before.
  async open(): Promise<void> {
    const bytes = await this.read(0, this.end(0));
    this.checkHeader(bytes);
    this.keep(0, bytes);
  }

  /// The record of a tile; null while its page is not there (it is then on its way), and of a damaged one.
  record(node: Node): TileRecord | null {
    const number = this.tree.record(node);
    const page = Math.floor(number / PAGE_RECORDS);
    const view = this.pages.get(page);
    if (view instanceof DataView) return this.recordAt(view, (number - page * PAGE_RECORDS) * RECORD_BYTES, node);
    if (view === undefined || performance.now() >= view.again) void this.fetch(page);
    return null;
  }

  /// Tells whether there will be nothing of a tile: it lies elsewhere, or its record is damaged.
  isLost(node: Node): boolean {
    return this.damaged.has(keyOf(node.level, node.index)) || this.lacks(node);
  }

  /// Where the file of a tile, but for the root, lies in an archive, in which tiles are side by side; null while its page is not there.
  whereabouts(node: Node): FilePlace | null {
    const number = this.tree.record(node);
    const page = Math.floor(number / PAGE_RECORDS);
    const view = this.pages.get(page);
    if (!(view instanceof DataView)) return null;
    const at = (number - page * PAGE_RECORDS) * RECORD_BYTES;
    const anchor = nodeAt(view, firstOf(page) * RECORD_BYTES);
    return { anchor: tilePath(anchor), distance: this.distancesOf(page, view)[at / RECORD_BYTES], bytes: bytesAt(view, at) };
  }

  /// Returns where each record's file begins, counted from the first one of the page.
  private distancesOf(page: number, view: DataView): Float64Array {
    let distances = this.distances.get(page);
    if (distances !== undefined) return distances;
    distances = new Float64Array(view.byteLength / RECORD_BYTES);
    for (let i = firstOf(page) + 1; i < distances.length; ++i) {
      const at = (i - 1) * RECORD_BYTES;
      distances[i] = distances[i - 1] + archivedBytes(tilePath(nodeAt(view, at)), bytesAt(view, at));
    }
    this.distances.set(page, distances);
    return distances;
  }

  private recordAt(view: DataView, at: number, node: Node): TileRecord | null {
    const { level, index } = nodeAt(view, at);
    const isIts = level === node.level && index === node.index;
    const record = readRecord(view, at, this.place);
    if (isIts && isSound(record)) return record;
    if (!this.damaged.has(keyOf(node.level, node.index))) {
      this.damaged.add(keyOf(node.level, node.index));
      this.onProblem(new HierarchyProblem(FILE, `the record of tile ${node.level}/${node.index} is damaged`));
    }
    return null;
  }

  private begin(page: number): number {
    return HEADER_BYTES + page * PAGE_RECORDS * RECORD_BYTES;
  }

  private end(page: number): number {
    return Math.min(this.begin(page + 1), indexSize(this.tree.tileCount));
  }

  private async fetch(page: number): Promise<void> {
    this.pages.set(page, { again: Infinity });
    try {
      this.keep(page, await this.read(this.begin(page), this.end(page)));
      this.onPage();
    } catch (problem) {
      this.pages.set(page, { again: performance.now() + RETRY_MS });
      this.onProblem(problem);
    }
  }

  private checkHeader(bytes: Uint8Array): void {
    if (bytes.length < HEADER_BYTES || new TextDecoder('latin1').decode(bytes.subarray(0, 8)) !== MAGIC)
      throw new HierarchyProblem(FILE, 'not an index of tiles');
    const view = new DataView(bytes.buffer, bytes.byteOffset);
    const known = VERSIONS.includes(view.getUint32(8, true)) && view.getUint32(12, true) === RECORD_BYTES;
    if (!known || view.getBigUint64(16, true) !== BigInt(this.tree.tileCount))
      throw new HierarchyProblem(FILE, 'another version, or of another hierarchy');
  }

  /// `bytes`: of the page (the first one's with the header), or the whole file.
  private keep(page: number, bytes: Uint8Array): void {
    if (bytes.length === indexSize(this.tree.tileCount)) {
      for (let each = 0; this.begin(each) < bytes.length; ++each)
        this.put(each, bytes.subarray(this.begin(each), this.end(each)));
      return;
    }
    const records = page === 0 ? bytes.subarray(HEADER_BYTES) : bytes;
    if (records.length !== this.end(page) - this.begin(page)) throw new HierarchyProblem(FILE, 'ends too early');
    this.put(page, records);
  }

  private put(page: number, records: Uint8Array): void {
    this.pages.set(page, new DataView(records.buffer, records.byteOffset, records.byteLength));
  }
}
