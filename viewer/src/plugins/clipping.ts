// SPDX-License-Identifier: MIT
// Draws a model cut open by planes, a closed one with caps. The renderer needs a stencil buffer: `new WebGLRenderer({ stencil: true })`.
import { Sphere, type Vector3 } from 'three';
import type { HierarchyView, Plugin } from '../scene/hierarchy_view.js';
import { ClippedPainter } from '../tools/caps.js';
import { worldPlane, type CutPlane } from '../tools/planes.js';
import type { Frame } from './plugin.js';

export class Clipping implements Plugin {
  readonly name = 'clipping';
  private view: HierarchyView | null = null;
  private painter: ClippedPainter | null = null;
  private planes: readonly CutPlane[] = [];

  init(view: HierarchyView): void {
    this.view = view;
    this.painter = new ClippedPainter(view, () => {
      const { center, radius } = view.box.clone().applyMatrix4(view.matrixWorld).getBoundingSphere(new Sphere());
      return { middle: center, reach: 1.1 * radius };
    });
  }

  /// `planes`: in the tiles' coordinates; none: the model is whole. `hasCaps`: where it is full.
  cut(planes: readonly CutPlane[], hasCaps = true): void {
    const { view, painter } = this;
    if (view === null || painter === null) return;
    this.planes = planes;
    painter.isCapped = hasCaps && view.closed;
    if (view.showsInside !== planes.length > 0) view.showsInside = planes.length > 0;
  }

  /// However the model stands now.
  paint({ renderer, scene, camera }: Frame): boolean {
    const { view, painter, planes } = this;
    if (view === null || painter === null || planes.length === 0) return false;
    painter.planes = planes.map((plane) => worldPlane(plane, view.surfaceMatrix));
    painter.paint(renderer, scene, camera);
    return true;
  }

  keeps(point: Vector3): boolean {
    const { view } = this;
    return view === null || this.planes.every((plane) => worldPlane(plane, view.surfaceMatrix).distanceToPoint(point) >= 0);
  }

  dispose(): void {
    this.cut([]);
    this.painter?.dispose();
    this.view = this.painter = null;
  }
}
