// The index, tiles.bin (docs/file_format.md, section 3), in pages: of a large one only those that are looked
// into are fetched.
import { HierarchyProblem } from './problem.js';
import type { Tree, Node } from './tree.js';

export interface TileRecord {
  readonly own: number;
  readonly ghosts: number;
  readonly interior: number;
  readonly border: number;
  /// Estimated distance to the input, in its units; 0 of partitions.
  readonly error: number;
  /// Box of the vertices, in the coordinates of decoded tiles.
  readonly min: readonly [number, number, number];
  readonly max: readonly [number, number, number];
  /// Of the tile's file.
  readonly bytes: number;
}

/// Bytes [first, end) of the index, or all of it where a host knows no ranges.
export type ReadRange = (first: number, end: number) => Promise<Uint8Array>;

const FILE = 'tiles.bin';
const MAGIC = 'MHTILES\n';
const VERSION = 2;
const HEADER_BYTES = 32;
const RECORD_BYTES = 96;
const PAGE_RECORDS = 682; // a page is just below 64 KiB
const MOST_OWN = 32768;

function readRecord(view: DataView, at: number, place: readonly number[]): TileRecord {
  const u32 = (offset: number): number => view.getUint32(at + offset, true);
  const f32 = (offset: number): number => view.getFloat32(at + offset, true);
  return {
    own: u32(8),
    ghosts: u32(16),
    interior: u32(20),
    border: u32(24),
    error: f32(44),
    min: [f32(56) - place[0], f32(60) - place[1], f32(64) - place[2]],
    max: [f32(68) - place[0], f32(72) - place[1], f32(76) - place[2]],
    bytes: Number(view.getBigUint64(at + 80, true)),
  };
}

/// No more than the format allows: sizes are computed from these.
function check(record: TileRecord, level: number, index: number): void {
  const counts = record.own >= 1 && record.own <= MOST_OWN && record.ghosts < 2 ** 26;
  const triangles = record.interior < 2 ** 26 && record.border < 2 ** 26;
  const box = [...record.min, ...record.max, record.error].every(Number.isFinite);
  if (!counts || !triangles || !box || record.error < 0)
    throw new HierarchyProblem(FILE, `the record of tile ${level}/${index} is damaged`);
}

export class TileIndex {
  private readonly pages = new Map<number, DataView | 'coming'>();

  /// `place`: what decoded tiles' positions are relative to, itself relative to the origin. `onPage` is called when a
  /// page has come, `onProblem` when one did not.
  constructor(
    private readonly tree: Tree,
    private readonly place: readonly number[],
    private readonly read: ReadRange,
    private readonly onPage: () => void,
    private readonly onProblem: (problem: unknown) => void,
  ) {}

  /// Fetches the header and the first page; nothing else works before.
  async open(): Promise<void> {
    const bytes = await this.read(0, this.end(0));
    this.checkHeader(bytes);
    this.keep(0, bytes);
  }

  /// The record of a tile, null while its page is not there: it is then on its way.
  record(node: Node): TileRecord | null {
    const number = this.tree.record(node);
    const page = Math.floor(number / PAGE_RECORDS);
    const view = this.pages.get(page);
    if (view === undefined) void this.fetch(page);
    if (!(view instanceof DataView)) return null;
    const at = (number - page * PAGE_RECORDS) * RECORD_BYTES;
    if (view.getUint32(at, true) !== node.level || view.getUint32(at + 4, true) !== node.index)
      throw new HierarchyProblem(FILE, `no record of tile ${node.level}/${node.index} in its place`);
    const record = readRecord(view, at, this.place);
    check(record, node.level, node.index);
    return record;
  }

  private begin(page: number): number {
    return HEADER_BYTES + page * PAGE_RECORDS * RECORD_BYTES;
  }

  private end(page: number): number {
    return Math.min(this.begin(page + 1), HEADER_BYTES + this.tree.tileCount * RECORD_BYTES);
  }

  private async fetch(page: number): Promise<void> {
    this.pages.set(page, 'coming');
    try {
      this.keep(page, await this.read(this.begin(page), this.end(page)));
      this.onPage();
    } catch (problem) {
      this.onProblem(problem);
    }
  }

  private checkHeader(bytes: Uint8Array): void {
    if (bytes.length < HEADER_BYTES || new TextDecoder('latin1').decode(bytes.subarray(0, 8)) !== MAGIC)
      throw new HierarchyProblem(FILE, 'not an index of tiles');
    const view = new DataView(bytes.buffer, bytes.byteOffset);
    const known = view.getUint32(8, true) === VERSION && view.getUint32(12, true) === RECORD_BYTES;
    if (!known || view.getBigUint64(16, true) !== BigInt(this.tree.tileCount))
      throw new HierarchyProblem(FILE, 'another version, or of another hierarchy');
  }

  /// `bytes`: of the page (the first one's with the header), or the whole file.
  private keep(page: number, bytes: Uint8Array): void {
    const whole = bytes.length === HEADER_BYTES + this.tree.tileCount * RECORD_BYTES;
    if (whole) {
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
