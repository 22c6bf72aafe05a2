// SPDX-License-Identifier: MIT
// A picture of any size: drawn in parts that every graphics card can draw, and written row by row.
import { PngWriter } from './png.js';

export interface PictureSize {
  readonly width: number;
  readonly height: number;
}

/// A part of a picture, in pixels from its upper left corner.
export interface Part extends PictureSize {
  readonly x: number;
  readonly y: number;
}

/// Draws a part: r, g, b, a with the colours multiplied by a, the lowest row first, as WebGL reads pixels.
export type DrawPart = (size: PictureSize, part: Part) => Uint8Array;

export interface PictureOptions {
  /// Pixels of a part's sides, at the most.
  readonly side?: number;
  /// The file tells how large the picture is in print.
  readonly dotsPerInch?: number;
  /// Ends it.
  readonly signal?: AbortSignal;
  /// Is told how many of the parts are done.
  readonly progress?: (done: number, all: number) => void;
}

/// Pixels of a side.
export const MOST_SIZE = 32768;
const PART_SIDE = 1024;

/// Rows of parts, from the top, each from the left.
export function partsOf({ width, height }: PictureSize, side = PART_SIDE): Part[][] {
  const starts = (length: number): number[] => Array.from({ length: Math.ceil(length / side) }, (_, i) => i * side);
  return starts(height).map((y) => starts(width).map((x) => ({ x, y, width: Math.min(side, width - x), height: Math.min(side, height - y) })));
}

/// Onto a ground of r, g, b, or none: then colours are those without their a.
function settle(pixels: Uint8Array, ground: readonly number[] | null): void {
  for (let i = 0; i < pixels.length; i += 4) {
    const alpha = pixels[i + 3];
    if (alpha === 255) continue;
    for (let k = 0; k < 3; ++k) {
      const value = ground ? pixels[i + k] + (ground[k] * (255 - alpha)) / 255 : alpha > 0 ? (pixels[i + k] * 255) / alpha : 0;
      pixels[i + k] = Math.min(255, Math.round(value));
    }
    if (ground) pixels[i + 3] = 255;
  }
}

/// Time for the page: to show how far it is, and to be told that it is enough.
function pause(): Promise<void> {
  return new Promise((resolve) => { setTimeout(resolve); });
}

/// Makes one row of parts, put side by side, the uppermost row first.
async function rowsOf(size: PictureSize, parts: readonly Part[], draw: (part: Part) => Promise<Uint8Array>): Promise<Uint8Array> {
  const bytes = 4 * size.width;
  const rows = new Uint8Array(bytes * parts[0].height);
  for (const part of parts) {
    const pixels = await draw(part);
    for (let row = 0; row < part.height; ++row)
      rows.set(pixels.subarray(4 * part.width * row, 4 * part.width * (row + 1)), (part.height - 1 - row) * bytes + 4 * part.x);
  }
  return rows;
}

/// `ground`: r, g, b from 0 to 255; null: nothing, transparent. Rejects with RangeError for sizes that are none, and when the signal aborts.
export async function takePicture(size: PictureSize, draw: DrawPart, ground: readonly number[] | null, options: PictureOptions = {}): Promise<Blob> {
  const { side = PART_SIDE, dotsPerInch = null, signal, progress } = options;
  for (const length of [size.width, size.height])
    if (!Number.isInteger(length) || length < 1 || length > MOST_SIZE) throw new RangeError(`a side of ${length} pixels, not from 1 to ${MOST_SIZE}`);
  const writer = new PngWriter(size.width, size.height, dotsPerInch);
  const all = partsOf(size, side);
  let done = 0;
  const drawn = async (part: Part): Promise<Uint8Array> => {
    await pause();
    signal?.throwIfAborted();
    const pixels = draw(size, part);
    progress?.(++done, all.length * all[0].length);
    return pixels;
  };
  for (const parts of all) {
    const rows = await rowsOf(size, parts, drawn);
    settle(rows, ground);
    await writer.write(rows);
  }
  return writer.finish();
}
