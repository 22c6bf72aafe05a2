// SPDX-License-Identifier: MIT
// From a place of the picture to a point of what is seen there.
import type { PickedPoint } from './picked_point.js';

export interface Pointed {
  readonly shown: PickedPoint;
  /// Null: it cannot be had; rejects when a later point was asked for.
  readonly original: Promise<PickedPoint | null>;
}

/// Finds points of a picture, from -1 to 1 to the right and up.
export interface PointFinder {
  /// Null: nothing of a model is there. `signal`: ends the way to the original.
  at(right: number, up: number, snaps: boolean, signal: AbortSignal): Pointed | null;
}
