// SPDX-License-Identifier: MIT
// The files of a progressive stream, run by run (docs/file_format.md, section 7).
import { drain } from '../hierarchy/bytes.js';
import { StreamError } from './stream_index.js';

export interface Run {
  list: 1 | 2 | 3;
  indices: Uint32Array;
  /// List 1: `width` residuals an entry. List 2: three corners. List 3: one target.
  entries: Uint32Array;
}

const MAGIC = 0x4c494154_4544484dn; // "MHDETAIL"
const VERSION = 1;
const HEAD_BYTES = 16;
const RUN_HEAD_BYTES = 12;
const MOST_ENTRIES = 65536;
const BEYOND = 2 ** 32;
const MOST_VARINT = 7; // bytes: see varint()

/// Bytes of an entry of a list, unpacked, at the most. `bytes`: of each value of a vertex.
function mostBytes(list: number, bytes: readonly number[]): number {
  if (list === 1) return MOST_VARINT + bytes.reduce((sum, more) => sum + more, 0);
  return MOST_VARINT * (list === 2 ? 4 : 2);
}

/// At most `most` bytes out of a gzip member.
async function gunzip(bytes: Uint8Array<ArrayBuffer>, most: number, name: string): Promise<Uint8Array> {
  try {
    return await drain(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip')), most, name);
  } catch {
    throw new StreamError(`${name}: a run is damaged`);
  }
}

/// Takes what is in a run's gzip member apart.
class Unpacker {
  private place = 0;
  constructor(
    private readonly bytes: Uint8Array,
    private readonly count: number,
    private readonly name: string,
  ) {}

  private fail(what: string): never {
    throw new StreamError(`${this.name}: ${what}`);
  }

  /// Below 2^53: the lower four bytes' bits are shifted, the others multiplied.
  private varint(): number {
    let value = 0;
    let scale = 1;
    for (;;) {
      const byte = this.bytes[this.place++];
      if (byte === undefined) this.fail('a run ends within its entries');
      value += (byte & 127) * scale;
      if (byte < 128) return value;
      scale *= 128;
      if (scale > 2 ** 42) this.fail('a number that is too large');
    }
  }

  private difference(from: number): number {
    const folded = this.varint();
    const value = folded % 2 === 0 ? from + folded / 2 : from - (folded + 1) / 2;
    if (value < 0 || value >= BEYOND) this.fail('a vertex that is no number of 32 bits');
    return value;
  }

  /// The index behind the last one.
  indices(to: Uint32Array, first: number): number {
    for (let i = 0; i < this.count; ++i) {
      const index = first + this.varint();
      if (index >= BEYOND) this.fail('an index that is too large');
      to[i] = index;
      first = index + 1;
    }
    return first;
  }

  residuals(to: Uint32Array, bytes: readonly number[]): void {
    for (let value = 0; value < bytes.length; ++value) {
      for (let byte = 0; byte < bytes[value]; ++byte) this.plane(to, value, bytes.length, 8 * byte);
    }
  }

  private plane(to: Uint32Array, value: number, width: number, shift: number): void {
    if (this.bytes.length - this.place < this.count) this.fail('a run ends within its entries');
    for (let i = 0, at = value; i < this.count; ++i, at += width) to[at] |= this.bytes[this.place++] << shift;
  }

  corners(to: Uint32Array): void {
    let before = 0;
    for (let i = 0; i < this.count; ++i) to[3 * i] = before = this.difference(before);
    for (let corner = 1; corner < 3; ++corner) {
      for (let i = 3 * 0 + corner; i < 3 * this.count; i += 3) to[i] = this.difference(to[i - 1]);
    }
  }

  targets(to: Uint32Array, vertices: Uint32Array): void {
    for (let i = 0; i < this.count; ++i) to[i] = this.difference(vertices[i]);
  }

  finish(): void {
    if (this.place !== this.bytes.length) this.fail('bytes are left in a run');
  }
}

/// All runs of a file, one after another. `bytes`: of each value of a vertex. Throws StreamError.
export async function* readRuns(
  file: Uint8Array<ArrayBuffer>,
  step: number,
  bytes: readonly number[],
  name: string,
): AsyncGenerator<Run> {
  const view = new DataView(file.buffer, file.byteOffset, file.byteLength);
  const begins =
    file.byteLength >= HEAD_BYTES &&
    view.getBigUint64(0, true) === MAGIC &&
    view.getUint32(8, true) === VERSION &&
    view.getUint32(12, true) === step;
  if (!begins) throw new StreamError(`${name}: does not start as the file of step ${step}`);
  let last = 1;
  let first = 0;
  for (let place = HEAD_BYTES; place < file.byteLength; ) {
    if (file.byteLength - place < RUN_HEAD_BYTES) throw new StreamError(`${name}: a run is cut`);
    const list = view.getUint32(place, true);
    const count = view.getUint32(place + 4, true);
    const packed = view.getUint32(place + 8, true);
    place += RUN_HEAD_BYTES;
    const sound = list >= last && list <= 3 && count >= 1 && count <= MOST_ENTRIES && packed <= file.byteLength - place;
    if (!sound) throw new StreamError(`${name}: byte ${place - RUN_HEAD_BYTES}: no run begins there`);
    const content = await gunzip(file.subarray(place, place + packed), count * mostBytes(list, bytes), name);
    const unpacker = new Unpacker(content, count, name);
    place += packed;
    const indices = new Uint32Array(count);
    first = unpacker.indices(indices, list === last ? first : 0);
    last = list;
    const entries = new Uint32Array(count * (list === 1 ? bytes.length : list === 2 ? 3 : 1));
    if (list === 1) unpacker.residuals(entries, bytes);
    else if (list === 2) unpacker.corners(entries);
    else unpacker.targets(entries, indices);
    unpacker.finish();
    yield { list: list as 1 | 2 | 3, indices, entries };
  }
}
