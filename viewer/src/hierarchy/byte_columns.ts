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
    const numbers = this.numbers(count, 4);
    return Array.from({ length: count }, (_, i) => numbers.getUint32(4 * i, true));
  }

  u64(count: number): bigint[] {
    const numbers = this.numbers(count, 8);
    return Array.from({ length: count }, (_, i) => numbers.getBigUint64(8 * i, true));
  }

  /// Finite numbers.
  f64(count: number): number[] {
    const bytes = this.numbers(count, 8);
    const numbers = Array.from({ length: count }, (_, i) => bytes.getFloat64(8 * i, true));
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

  /// The numbers one behind the other, each put together from its planes.
  private numbers(count: number, width: number): DataView {
    const planes = this.take(count * width);
    const bytes = new Uint8Array(planes.length);
    for (let plane = 0; plane < width; ++plane) for (let i = 0; i < count; ++i) bytes[i * width + plane] = planes[plane * count + i];
    return new DataView(bytes.buffer);
  }
}
