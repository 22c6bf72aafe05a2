// SPDX-License-Identifier: MIT
// A tile before its normal map has come, which is the last section of its file and most of the bytes:
//
//   head | JSON | positions … indices | normal map
//                                     ^ from here on the tile can be drawn without its map
import { isGzip } from './bytes.js';
import { CHUNK_HEAD_BYTES, endOf, HEAD_BYTES, parseDocument, readHead } from './glb_container.js';
import type { Gltf } from './glb.js';

/// Nothing is begun of a file that says to be longer.
const MOST_BYTES = 2 ** 26;

/// The bytes of a stream, from the first one on.
class Prefix {
  private bytes = new Uint8Array(2 ** 16);
  private length = 0;

  constructor(private readonly reader: ReadableStreamDefaultReader<Uint8Array>) {}

  /// Throws RangeError if the stream ends before.
  async upTo(end: number): Promise<Uint8Array> {
    while (this.length < end) {
      const { done, value } = await this.reader.read();
      if (done) throw new RangeError('the stream has ended');
      this.add(value);
    }
    return this.bytes.subarray(0, end);
  }

  private add(piece: Uint8Array): void {
    const length = this.length + piece.length;
    if (length > this.bytes.length) {
      const larger = new Uint8Array(Math.max(length, 2 * this.bytes.length));
      larger.set(this.bytes.subarray(0, this.length));
      this.bytes = larger;
    }
    this.bytes.set(piece, this.length);
    this.length = length;
  }
}

/// Finds the first byte of the normal map in the BIN chunk, if all else lies before it; null: there is no such map.
function mapStart({ extensions, bufferViews }: Gltf): number | null {
  const map = bufferViews[extensions.MESHHIER_tile.normalMap ?? -1];
  if (map === undefined) return null;
  const start = map.byteOffset ?? 0;
  return bufferViews.every((view) => view === map || endOf(view) <= start) ? start : null;
}

/// Null: there is nothing to begin with.
async function readBeginning(file: Prefix, name: string): Promise<Uint8Array<ArrayBuffer> | null> {
  const { bytes: length, jsonBytes } = readHead(await file.upTo(HEAD_BYTES), name);
  if (length > MOST_BYTES) return null;
  const binStart = HEAD_BYTES + jsonBytes + CHUNK_HEAD_BYTES;
  const json = (await file.upTo(binStart)).subarray(HEAD_BYTES, HEAD_BYTES + jsonBytes);
  const start = mapStart(parseDocument(json, name) as Gltf);
  if (start === null || binStart + start >= length) return null;
  const bytes = new Uint8Array(length);
  bytes.set(await file.upTo(binStart + start));
  return bytes;
}

export class TileBeginning {
  private writer: WritableStreamDefaultWriter<Uint8Array<ArrayBuffer>> | null = null;

  /// `there`: is given the file, out of its gzip, with zeros in place of its map, as soon as all else has come; never where nothing can be begun
  /// with, or something is wrong: whoever reads the whole file is told.
  constructor(private readonly name: string, private readonly there: (bytes: Uint8Array<ArrayBuffer>) => void) {}

  /// Takes the pieces of the file as they come.
  readonly take = (piece: Uint8Array): void => {
    this.writer ??= this.begin(isGzip(piece));
    this.writer.write(piece as Uint8Array<ArrayBuffer>).catch(() => undefined);
  };

  private begin(isPacked: boolean): WritableStreamDefaultWriter<Uint8Array<ArrayBuffer>> {
    const { readable, writable } = isPacked ? new DecompressionStream('gzip') : new TransformStream<Uint8Array<ArrayBuffer>, Uint8Array>();
    void this.read(readable.getReader());
    return writable.getWriter();
  }

  private async read(reader: ReadableStreamDefaultReader<Uint8Array>): Promise<void> {
    const bytes = await readBeginning(new Prefix(reader), this.name).catch(() => null);
    reader.cancel().catch(() => undefined); // what still comes is let go
    if (bytes !== null) this.there(bytes);
  }
}
