// SPDX-License-Identifier: MIT
// Where a hierarchy's picture, preview.webp, stands in place of the model: as large as the first camera shows that.
import { FRAME_MARGIN } from './frame_margin.js';

/// As parts of the picture's side: smallest, then largest; y down.
export interface PictureBox {
  readonly min: readonly [number, number];
  readonly max: readonly [number, number];
}

const COVERED = 128; // of 255: a pixel belongs to the model

/// Returns the columns and rows that anything covers; null: nothing does.
export function coveredBox(alpha: (x: number, y: number) => number, side: number): PictureBox | null {
  let [left, top, right, bottom] = [side, side, 0, 0];
  for (let y = 0; y < side; ++y) {
    for (let x = 0; x < side; ++x) {
      if (alpha(x, y) < COVERED) continue;
      [left, right] = [Math.min(left, x), Math.max(right, x + 1)];
      [top, bottom] = [Math.min(top, y), y + 1];
    }
  }
  return right === 0 ? null : { min: [left / side, top / side], max: [right / side, bottom / side] };
}

/// Returns the part of a square picture that the model covers; null: none, or the page may not see it. `image`: decoded.
export function boxOf(image: HTMLImageElement): PictureBox | null {
  const side = image.naturalWidth;
  const context = Object.assign(document.createElement('canvas'), { width: side, height: side }).getContext('2d', { willReadFrequently: true });
  if (context === null || side === 0 || image.naturalHeight !== side) return null;
  context.drawImage(image, 0, 0);
  const { data } = context.getImageData(0, 0, side, side);
  return coveredBox((x, y) => data[4 * (y * side + x) + 3], side);
}

/// Returns where the whole picture stands in a window, in its pixels, so that the model is in its middle and takes as much of it as with the first
/// camera.
export function placeIn({ min, max }: PictureBox, width: number, height: number): { left: number; top: number; side: number } {
  const side = Math.min(width / (max[0] - min[0]), height / (max[1] - min[1])) / FRAME_MARGIN;
  return { left: width / 2 - (side * (min[0] + max[0])) / 2, top: height / 2 - (side * (min[1] + max[1])) / 2, side };
}
