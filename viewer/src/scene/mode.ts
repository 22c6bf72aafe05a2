// SPDX-License-Identifier: MIT
// Names a view's mode (Kim & Lee).
import type { ChosenNode } from '../cut/choose_cut.js';
import { areInView, distance, pixelsOf, type Viewpoint } from '../cut/viewpoint.js';
import type { Mode } from './settings.js';

/// Part of the picture that a tile covers, at most.
function share({ record }: ChosenNode, view: Viewpoint, pixels: number): number {
  const size = Math.hypot(...record.max.map((max, axis) => max - record.min[axis]));
  return Math.min(1, pixelsOf(view, record, size) ** 2 / pixels);
}

/// The closest of the tiles in view that together can fill the picture: others are hardly seen behind them.
function foremost(shown: readonly ChosenNode[], view: Viewpoint, pixels: number): ChosenNode[] {
  const sorted = [...shown].sort((a, b) => distance(view, a.record) - distance(view, b.record));
  let filled = 0;
  return sorted.filter((each) => {
    const isFree = filled < 1;
    filled += share(each, view, pixels);
    return isFree;
  });
}

/// `shown`: the tiles in view, `silhouette`: x, y, z of points of the model's outline, `pixels`: of the picture.
export function modeOf(shown: readonly ChosenNode[], silhouette: ArrayLike<number>, lastLevel: number, view: Viewpoint, pixels: number): Mode {
  if (areInView(view, silhouette)) return 'CWV';
  const front = foremost(shown, view, pixels);
  return front.length > 0 && front.every(({ node }) => node.level === lastLevel) ? 'DZM' : 'ZSV';
}
