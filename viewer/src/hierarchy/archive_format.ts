// SPDX-License-Identifier: MIT
// A hierarchy's archive, NAME.3tz (docs/file_format.md, section 8): a zip of stored files, what comes first in it, and its
// index of names. Nothing of it is trusted: offsets and sizes are checked where they are used.
import { HierarchyProblem } from './problem.js';

const LOCAL_BYTES = 30;
const END_BYTES = 22;
const END64_BYTES = 56 + 20;
const PLACE_BYTES = 24;
const LOCAL_MARK = 0x04034b50;
const END_MARK = 0x06054b50;
const END64_MARK = 0x06064b50;
const INDEX_FILE = '@3dtilesIndex1@';

/// Tells whether a URL is that of an archive. One that ends with a slash is that of a directory: of a server that shows what is
/// in the archive.
export function isArchiveUrl(url: string): boolean {
  return /^[^?#]*\.3tz([?#]|$)/i.test(url);
}

/// The beginning of an archive that is asked for first: it holds the manifest and the header of the root.
export const HEAD_BYTES = 2 ** 14;
/// An archive's end has no more bytes.
export const MOST_END_BYTES = END_BYTES + END64_BYTES;
/// A file's header has no more bytes.
export const MOST_LOCAL_BYTES = LOCAL_BYTES + 255;

export interface LocalHeader {
  readonly name: string;
  /// The length of the content, which follows the header.
  readonly bytes: number;
  readonly headerBytes: number;
}

/// Returns the bytes that a file takes in an archive.
export function archivedBytes(name: string, bytes: number): number {
  return LOCAL_BYTES + name.length + bytes;
}

function viewOf(bytes: Uint8Array): DataView {
  return new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
}

export function beginsAsArchive(bytes: Uint8Array): boolean {
  return bytes.length >= 4 && viewOf(bytes).getUint32(0, true) === LOCAL_MARK;
}

/// The header that `bytes` begin with; null if they end before it does. Throws HierarchyProblem of `archive`.
export function readLocalHeader(bytes: Uint8Array, archive: string): LocalHeader | null {
  if (bytes.length < LOCAL_BYTES) return null;
  const view = viewOf(bytes);
  const [size, again] = [view.getUint32(18, true), view.getUint32(22, true)];
  const isStored = view.getUint32(0, true) === LOCAL_MARK && view.getUint32(6, true) === 0 && size === again && size < 2 ** 32 - 1;
  const nameBytes = view.getUint16(26, true);
  if (!isStored || nameBytes === 0 || nameBytes > 255 || view.getUint16(28, true) !== 0)
    throw new HierarchyProblem(archive, 'has something else where a file should begin: it is damaged, or another program has packed it');
  const headerBytes = LOCAL_BYTES + nameBytes;
  if (bytes.length < headerBytes) return null;
  return { name: new TextDecoder('latin1').decode(bytes.subarray(LOCAL_BYTES, headerBytes)), bytes: size, headerBytes };
}

/// Where the index of names lies: `count` places from `offset` on.
export interface IndexPlace {
  readonly offset: number;
  readonly count: number;
}

/// `last`: the last bytes of an archive of `total`, MOST_END_BYTES or all. Throws HierarchyProblem of `archive`.
export function readEnd(last: Uint8Array, total: number, archive: string): IndexPlace {
  const refuse = (): never => {
    throw new HierarchyProblem(archive, 'does not end as an archive does: it is cut or damaged');
  };
  if (last.length < END_BYTES) return refuse();
  const view = viewOf(last);
  const end = last.length - END_BYTES;
  if (view.getUint32(end, true) !== END_MARK || view.getUint16(end + 20, true) !== 0) return refuse();
  let [files, bytes, offset] = [view.getUint16(end + 10, true), view.getUint32(end + 12, true), view.getUint32(end + 16, true)];
  let endBytes = END_BYTES;
  if (files === 0xffff || bytes === 0xffffffff || offset === 0xffffffff) {
    const end64 = end - END64_BYTES;
    if (end64 < 0 || view.getUint32(end64, true) !== END64_MARK) return refuse();
    [files, bytes, offset] = [32, 40, 48].map((at) => Number(view.getBigUint64(end64 + at, true)));
    endBytes = MOST_END_BYTES;
  }
  const count = files - 1; // but for the index itself
  const index = offset - PLACE_BYTES * count;
  if (offset + bytes + endBytes !== total || count < 1 || index < LOCAL_BYTES + INDEX_FILE.length) return refuse();
  return { offset: index, count };
}

type ReadBytes = (first: number, end: number) => Promise<Uint8Array>;

/// As the index is ordered by.
interface Key {
  readonly high: bigint;
  readonly low: bigint;
}

function keyAt(bytes: Uint8Array, at = 0): Key {
  const view = viewOf(bytes);
  return { high: view.getBigUint64(at, true), low: view.getBigUint64(at + 8, true) };
}

function compare(a: Key, b: Key): number {
  if (a.high !== b.high) return a.high < b.high ? -1 : 1;
  return a.low === b.low ? 0 : a.low < b.low ? -1 : 1;
}

/// Places of the index that are read at once: 64 KiB.
const LEAST_WINDOW = 2730;
const MOST_STEPS = 8;

/// Half of the places that a hash is among, seen from where it is expected: four standard deviations of as many evenly
/// spread ones.
function spreadOf(count: number): number {
  return Math.ceil(2 * Math.sqrt(count)) + 1;
}

/// The offset of the local header of the file whose name has that MD5; null: there is none. Hashes are spread evenly:
/// where they are is known before they are read, but for a few (interpolation search). One read, seldom two. Throws
/// HierarchyProblem of `archive` if the index is not in order.
export async function findInIndex(md5: Uint8Array, { offset, count }: IndexPlace, read: ReadBytes, archive: string): Promise<number | null> {
  const wanted = keyAt(md5);
  let [low, high] = [0, count]; // it is in there
  let [least, most] = [0n, 2n ** 64n];
  for (let step = 0; step < MOST_STEPS; ++step) {
    const share = most === least ? 0 : Number(wanted.high - least) / Number(most - least);
    const half = Math.max(spreadOf(high - low), LEAST_WINDOW / 2);
    const middle = low + Math.floor(Math.min(Math.max(share, 0), 1) * (high - low));
    const first = Math.max(low, Math.min(middle - half, high - 2 * half));
    const end = Math.min(high, first + 2 * half);
    const places = await read(offset + PLACE_BYTES * first, offset + PLACE_BYTES * end);
    const found = findAmong(wanted, places);
    if (found !== null) return found;
    const before = compare(wanted, keyAt(places)) < 0;
    const last = keyAt(places, places.length - PLACE_BYTES);
    if (before) [high, most] = [first, keyAt(places).high];
    else if (compare(wanted, last) > 0) [low, least] = [end, last.high];
    else return null;
    if (low >= high) return null;
  }
  throw new HierarchyProblem(archive, 'its index of files is not in order');
}

/// Searches by halving.
function findAmong(wanted: Key, places: Uint8Array): number | null {
  let [low, high] = [0, places.length / PLACE_BYTES];
  while (low < high) {
    const middle = Math.floor((low + high) / 2);
    const order = compare(wanted, keyAt(places, PLACE_BYTES * middle));
    if (order === 0) return Number(viewOf(places).getBigUint64(PLACE_BYTES * middle + 16, true));
    if (order < 0) high = middle;
    else low = middle + 1;
  }
  return null;
}
