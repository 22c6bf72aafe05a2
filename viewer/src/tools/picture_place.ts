// SPDX-License-Identifier: MIT
// Where in a picture a point is.
import type { Vector4 } from 'three';

export interface PicturePlace {
  readonly x: number;
  readonly y: number;
}

/// Pixels from the left upper corner of a picture of that size; `clip`: behind the camera's projection.
export function placeOf({ x, y, w }: Vector4, { clientWidth, clientHeight }: Pick<Element, 'clientWidth' | 'clientHeight'>): PicturePlace {
  return { x: ((x / w + 1) / 2) * clientWidth, y: ((1 - y / w) / 2) * clientHeight };
}
