// SPDX-License-Identifier: MIT
// Numbers and texts in columns (docs/file_format.md, section 9), of bytes that nobody vouches for.
import type { Fail } from '../json_value.js';

/// Compares as files are sorted: byte by byte.
export function compareBytes(a: Uint8Array, b: Uint8Array): number {
  const common = Math.min(a.length, b.length);
  for (let i = 0; i < common; ++i) if (a[i] !== b[i]) return a[i] - b[i];
  return a.length - b.length;
}

export function beginsWith(bytes: Uint8Array, start: Uint8Array): boolean {
  return bytes.length >= start.length && compareBytes(bytes.subarray(0, start.length), start) === 0;
}

const UTF8 = new TextDecoder('utf-8', { fatal: true, ignoreBOM: true });

/// Reads one column behind the other.
export class ColumnReader {
  private at = 0;

  constructor(
    private readonly bytes: Uint8Array,
    readonly fail: Fail,
  ) {}

  bytesOf(count: number): Uint8Array {
    return this.take(count);
  }

  u32(count: number): number[] {
    return Array.from(this.numbers(count, 4), (view) => view.getUint32(0, true));
  }

  u64(count: number): bigint[] {
    return Array.from(this.numbers(count, 8), (view) => view.getBigUint64(0, true));
  }

  /// Finite numbers.
  f64(count: number): number[] {
    const numbers = Array.from(this.numbers(count, 8), (view) => view.getFloat64(0, true));
    return numbers.every(Number.isFinite) ? numbers : this.fail('a number is not finite');
  }

  texts(count: number): Uint8Array[] {
    return this.u32(count).map((length) => this.take(length));
  }

  /// The text of bytes.
  decoded(bytes: Uint8Array): string {
    try {
      return UTF8.decode(bytes);
    } catch {
      return this.fail('a text is no UTF-8');
    }
  }

  /// Places of the ones in a column of zeros and ones.
  marked(count: number): number[] {
    const marks = this.take(count);
    if (marks.some((mark) => mark > 1)) this.fail('a mark is neither 0 nor 1');
    return Array.from(marks.keys()).filter((i) => marks[i] === 1);
  }

  finish(): void {
    if (this.at !== this.bytes.length) this.fail('goes on behind its last column');
  }

  private take(bytes: number): Uint8Array {
    if (bytes > this.bytes.length - this.at) this.fail('ends within a column');
    this.at += bytes;
    return this.bytes.subarray(this.at - bytes, this.at);
  }

  /// Each number's bytes, put together from their planes.
  private *numbers(count: number, width: number): Generator<DataView> {
    const planes = this.take(count * width);
    const view = new DataView(new ArrayBuffer(width));
    for (let i = 0; i < count; ++i) {
      for (let plane = 0; plane < width; ++plane) view.setUint8(plane, planes[plane * count + i]);
      yield view;
    }
  }
}
