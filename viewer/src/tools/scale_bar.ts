// SPDX-License-Identifier: MIT
// A bar of a round length, as long in the picture as that length is at one depth.
import type { LengthScale } from './units.js';

export interface ScaleBar {
  readonly pixels: number;
  readonly text: string;
}

const ROUND = [5, 2, 1];

/// The largest of 1, 2 and 5 times a power of ten that is not above `most`.
export function roundLength(most: number): number {
  const power = 10 ** Math.floor(Math.log10(most));
  const digit = ROUND.find((each) => each * power <= most * (1 + 1e-12)) ?? 1;
  return Number((digit * power).toPrecision(1));
}

/// Returns the model's units that a pixel is at a depth ahead of the camera; at all depths, where rays are parallel, as at 1. `steepness`: the projection's for heights, `height`: pixels.
export function unitsPerPixel(depth: number, steepness: number, height: number): number {
  return (2 * depth) / (steepness * height);
}

/// Null where nothing can be told: no size, no depth.
export function scaleBar(perPixel: number, mostPixels: number, scale: LengthScale): ScaleBar | null {
  const shownPerPixel = perPixel * scale.factor;
  if (!(shownPerPixel > 0) || !Number.isFinite(shownPerPixel)) return null;
  const length = roundLength(shownPerPixel * mostPixels);
  return { pixels: length / shownPerPixel, text: scale.format(length / scale.factor) };
}
