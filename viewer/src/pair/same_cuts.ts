// SPDX-License-Identifier: MIT
// Cuts one view open where another one is.
import type { Plane, Vector3 } from 'three';
import type { HierarchyView, Plugin } from '../scene/hierarchy_view.js';
import type { Frame } from '../plugins/plugin.js';
import { cutPainter } from '../plugins/cut_painter.js';
import type { ClippedPainter } from '../tools/caps.js';

export class SameCuts implements Plugin {
  readonly name = 'pair cuts';
  private view: HierarchyView | null = null;
  private painter: ClippedPainter | null = null;

  /// `other`: it is cut by planes of the world.
  constructor(private readonly other: HierarchyView) {}

  init(view: HierarchyView): void {
    this.view = view;
    this.painter = cutPainter(view);
  }

  get cuts(): readonly Plane[] {
    return this.other.plugins.cuts;
  }

  paint({ renderer, scene, camera }: Frame): boolean {
    const { painter, view, cuts } = this;
    if (painter === null || view === null || cuts.length === 0) return false;
    painter.planes = cuts;
    painter.isCapped = view.closed && this.other.plugins.isCapped;
    painter.paint(renderer, scene, camera);
    return true;
  }

  keeps(point: Vector3): boolean {
    return this.cuts.every((plane) => plane.distanceToPoint(point) >= 0);
  }

  dispose(): void {
    this.painter?.dispose();
    this.view = this.painter = null;
  }
}
