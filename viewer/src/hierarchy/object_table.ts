// SPDX-License-Identifier: MIT
// The names and properties of a model's objects, objects.bin (docs/file_format.md, section 9): the directory is fetched once, then a block
// a question.
import { beginsWith, compareBytes } from './byte_columns.js';
import { unpacked } from './bytes.js';
import { checksum } from './checksum.js';
import { MOST_KEY_BYTES, readBlock, readColumn, readDirectory, type BlockPlace, type ObjectBlock, type ObjectRow, type ObjectValue } from './object_blocks.js';
import { END_BYTES, MOST_DIRECTORY, type ObjectProperty, type TableFacts } from './object_facts.js';
import { HierarchyProblem } from './problem.js';

/// Blocks that are kept, of about 20 kB each.
const KEPT_BLOCKS = 64;

/// All blocks are fetched in pieces of so many bytes.
const PIECE_BYTES = 2 ** 20;

/// Bytes [first, end) of the file, or all of it where a host knows no ranges.
export type ReadPart = (first: number, end: number) => Promise<Uint8Array<ArrayBuffer>>;

/// Objects from `begin` up to `end`.
export interface ObjectRange {
  readonly begin: number;
  readonly end: number;
}

/// The first object of a block, and with what its name begins.
export interface BlockStart {
  readonly object: number;
  readonly beginning: string;
  /// The beginning is all of the name.
  readonly isWhole: boolean;
}

/// Values of a property, of objects from `first` on.
export interface ColumnPart {
  readonly first: number;
  readonly values: readonly ObjectValue[];
}

/// Whether a name, in UTF-8, comes before what is looked for; of ascending names it does up to one of them.
type IsBefore = (name: Uint8Array) => boolean;

/// The first place that is not before.
function partitionPoint(count: number, isBefore: (i: number) => boolean): number {
  let [begin, end] = [0, count];
  while (begin < end) {
    const middle = (begin + end) >> 1;
    if (isBefore(middle)) begin = middle + 1;
    else end = middle;
  }
  return begin;
}

/// Keys may end within a character.
const CUT = new TextDecoder('utf-8', { ignoreBOM: true });

/// Blocks that follow each other, about PIECE_BYTES together.
function runsOf(places: readonly BlockPlace[]): BlockPlace[][] {
  const runs: BlockPlace[][] = [];
  for (const place of places) {
    const last = runs.at(-1);
    if (last !== undefined && place.end - last[0].begin <= PIECE_BYTES) last.push(place);
    else runs.push([place]);
  }
  return runs;
}

/// What fails rejects with HierarchyProblem, and may be tried again.
export class ObjectTable {
  private whole: Uint8Array<ArrayBuffer> | null = null; // of a host that knows no ranges
  private opened: Promise<readonly BlockPlace[]> | null = null;
  /// The one used last last.
  private readonly kept = new Map<number, Promise<ObjectBlock>>();

  /// `words`: the table of the names' words; null: there is none.
  constructor(
    private readonly facts: TableFacts,
    private readonly read: ReadPart,
    readonly words: ObjectTable | null = null,
  ) {}

  get file(): string {
    return this.facts.file;
  }

  get count(): number {
    return this.facts.count;
  }

  get properties(): readonly ObjectProperty[] {
    return this.facts.properties;
  }

  /// Requires 0 <= object < count.
  async row(object: number): Promise<ObjectRow> {
    const [row] = await this.rows({ begin: object, end: object + 1 });
    return row;
  }

  /// The rows of a range; all of the blocks that they are in are fetched.
  async rows({ begin, end }: ObjectRange): Promise<ObjectRow[]> {
    const places = await this.places();
    const of = (object: number): number => partitionPoint(places.length, (i) => places[i].first <= object) - 1;
    if (begin >= end) return [];
    const blocks = await Promise.all(places.slice(of(begin), of(end - 1) + 1).map((place) => this.block(place)));
    return blocks.flatMap(({ rows }) => rows).filter(({ object }) => object >= begin && object < end);
  }

  /// The parts of a range that are in one block each.
  async blocksOf({ begin, end }: ObjectRange): Promise<ObjectRange[]> {
    if (begin >= end) return [];
    const places = await this.places();
    const first = partitionPoint(places.length, (i) => places[i].first + places[i].count <= begin);
    const behind = partitionPoint(places.length, (i) => places[i].first < end);
    return places.slice(first, behind).map((place) => ({ begin: Math.max(begin, place.first), end: Math.min(end, place.first + place.count) }));
  }

  /// The object of that name; null: there is none.
  async find(name: string): Promise<ObjectRow | null> {
    const { begin, end } = await this.range(name);
    const row = begin < end ? await this.row(begin) : null;
    return row?.name === name ? row : null;
  }

  /// The objects whose names begin with `prefix`; all of an empty one.
  async range(prefix: string): Promise<ObjectRange> {
    const start = new TextEncoder().encode(prefix);
    const begin = await this.firstNot((name) => compareBytes(name, start) < 0);
    return { begin, end: await this.firstNot((name) => compareBytes(name, start) < 0 || beginsWith(name, start)) };
  }

  /// At most `most` of the objects whose names begin with `prefix`, the first ones.
  async startingWith(prefix: string, most: number): Promise<ObjectRow[]> {
    const { begin, end } = await this.range(prefix);
    return this.rows({ begin, end: Math.min(end, begin + most) });
  }

  /// The blocks that begin within a range, but not where it begins: the directory says it.
  async starts({ begin, end }: ObjectRange): Promise<BlockStart[]> {
    const within = (await this.places()).filter(({ first }) => first > begin && first < end);
    return within.map(({ first, key }) => ({ object: first, beginning: CUT.decode(key), isWhole: key.length < MOST_KEY_BYTES }));
  }

  /// Yields the values of the property at that place, of all objects in their order: the file is read once, in pieces, and nothing of it is kept.
  async *column(at: number): AsyncGenerator<ColumnPart> {
    for (const run of runsOf(await this.places())) {
      const [{ begin }, { end }] = [run[0], run[run.length - 1]];
      const bytes = await this.part(begin, end);
      for (const place of run) {
        const plain = await this.unpackedBytes(bytes.slice(place.begin - begin, place.end - begin), place.end - place.begin, place.checksum, place.unpacked);
        yield { first: place.first, values: readColumn(plain, place, this.facts.properties, at, this.fail) };
      }
    }
  }

  private async firstNot(isBefore: IsBefore): Promise<number> {
    const places = await this.places();
    let [begin, end] = [0, places.length];
    while (begin < end) {
      const middle = (begin + end) >> 1;
      const { key } = places[middle];
      const name = key.length < MOST_KEY_BYTES ? key : (await this.block(places[middle])).names[0];
      if (isBefore(name)) begin = middle + 1;
      else end = middle;
    }
    if (begin === 0) return 0;
    const place = places[begin - 1];
    const { names } = await this.block(place);
    return place.first + partitionPoint(names.length, (i) => isBefore(names[i]));
  }

  private places(): Promise<readonly BlockPlace[]> {
    this.opened ??= this.open().catch((problem: unknown) => {
      this.opened = null;
      throw problem;
    });
    return this.opened;
  }

  private async open(): Promise<BlockPlace[]> {
    const { bytes, count, properties, directory } = this.facts;
    const begin = bytes - END_BYTES - directory.bytes;
    const plain = await this.unpackedPart(begin, begin + directory.bytes, directory.checksum, MOST_DIRECTORY);
    return readDirectory(plain, properties, count, begin, this.fail);
  }

  private block(place: BlockPlace): Promise<ObjectBlock> {
    const block = this.kept.get(place.first) ?? this.readBlock(place);
    this.kept.delete(place.first);
    this.kept.set(place.first, block);
    const [oldest] = this.kept.keys();
    if (this.kept.size > KEPT_BLOCKS) this.kept.delete(oldest);
    block.catch(() => { if (this.kept.get(place.first) === block) this.kept.delete(place.first); });
    return block;
  }

  private async readBlock(place: BlockPlace): Promise<ObjectBlock> {
    const plain = await this.unpackedPart(place.begin, place.end, place.checksum, place.unpacked);
    return readBlock(plain, place, this.facts.properties, this.fail);
  }

  private async unpackedPart(first: number, end: number, sum: bigint, most: number): Promise<Uint8Array> {
    return this.unpackedBytes(await this.part(first, end), end - first, sum, most);
  }

  private async unpackedBytes(part: Uint8Array<ArrayBuffer>, length: number, sum: bigint, most: number): Promise<Uint8Array> {
    if (part.length !== length || checksum(part) !== sum) this.fail('a part of it has another checksum: it is damaged, or of another build');
    return unpacked(part, most, this.file);
  }

  private readonly fail = (what: string): never => {
    throw new HierarchyProblem(this.file, what);
  };

  private async part(first: number, end: number): Promise<Uint8Array<ArrayBuffer>> {
    const read = this.whole ?? (await this.read(first, end));
    if (read.length !== this.facts.bytes) return read;
    this.whole = read;
    return read.slice(first, end);
  }
}
