// SPDX-License-Identifier: MIT
// Another model in the same picture: the parts that draw and point know this of it.
import type { Box3, Vector3 } from 'three';
import type { Viewport } from '../../src/scene/motion.js';
import type { PointFinder } from '../../src/tools/point_finder.js';

export interface Partner {
  /// Pictures beside each other.
  readonly columns: 1 | 2;
  /// Holds both views, in the world.
  readonly box: Box3;
  readonly points: PointFinder;
  readonly isSettled: boolean;
  shape(): Iterable<Vector3>;
  /// Instead of the view's own.
  update(viewport: Viewport, now: number): boolean;
  /// Draws the picture, without what plug-ins do afterwards.
  paint(): void;
  /// A frame is complete.
  drawn(): void;
  /// A place of the picture, within the column that it lies in.
  inColumn(right: number, up: number): readonly [number, number];
  /// At a place of a column.
  pick(right: number, up: number): Vector3 | null;
}
