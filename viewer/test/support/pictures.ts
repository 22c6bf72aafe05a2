// SPDX-License-Identifier: MIT
// Pictures as files; JPEG and WebP no more of them than tells their sizes.
import { png as paintedPng } from '../../../tests/web/png.mjs';
import { pictureSize } from '../../src/hierarchy/picture_size.js';

function bytesOf(...parts: readonly (string | readonly number[])[]): Uint8Array {
  return Uint8Array.from(parts.flatMap((part) => (typeof part === 'string' ? [...new TextEncoder().encode(part)] : part)));
}

function big(value: number): number[] {
  return [24, 16, 8, 0].map((shift) => (value >>> shift) & 255);
}

/// All black.
export function png(width: number, height: number): Uint8Array {
  return paintedPng(width, height, () => [0, 0, 0]);
}

/// Its head: a comment, a table, then the frame with `marker`.
export function jpeg(width: number, height: number, marker = 0xc2): Uint8Array {
  const short = (value: number): number[] => big(value).slice(2);
  const frame = [0xff, 0xff, marker, ...short(17), 8, ...short(height), ...short(width), 3];
  return bytesOf([0xff, 0xd8, 0xff, 0xe0], short(8), 'JFIF\0\x01', [0xff, 0xc4], short(4), [1, 2], frame);
}

/// Its head, of one of the three kinds.
export function webp(kind: 'VP8 ' | 'VP8L' | 'VP8X', width: number, height: number): Uint8Array {
  const little = (value: number, bytes: number): number[] => big(value).reverse().slice(0, bytes);
  const heads = {
    'VP8 ': [0, 0, 0, 0x9d, 1, 0x2a, ...little(width, 2), ...little(height, 2)],
    VP8L: [0x2f, ...little((width - 1) + (height - 1) * 2 ** 14, 4), 0, 0, 0, 0, 0],
    VP8X: [0, 0, 0, 0, ...little(width - 1, 3), ...little(height - 1, 3)],
  };
  return bytesOf('RIFF', [99, 0, 0, 0], 'WEBP', kind, [10, 0, 0, 0], heads[kind]);
}

/// Returns what a browser makes of a picture.
export class FakeBitmap {
  static open = 0;
  isClosed = false;

  constructor(
    private readonly openWidth: number,
    private readonly openHeight: number,
  ) {
    ++FakeBitmap.open;
  }

  get width(): number {
    return this.isClosed ? 0 : this.openWidth;
  }

  get height(): number {
    return this.isClosed ? 0 : this.openHeight;
  }

  close(): void {
    if (!this.isClosed) --FakeBitmap.open;
    this.isClosed = true;
  }
}

/// Instead of a browser's: of the size that the file tells.
export async function fakeDecode(file: Blob): Promise<FakeBitmap> {
  const size = pictureSize(new Uint8Array(await file.arrayBuffer()), file.type);
  if (size === null) throw new DOMException('no picture', 'InvalidStateError');
  return new FakeBitmap(size.width, size.height);
}
