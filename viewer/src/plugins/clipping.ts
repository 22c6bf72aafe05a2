// SPDX-License-Identifier: MIT
// Draws a model cut open by planes, a closed one with caps; by those of other plug-ins, too. The renderer needs a stencil buffer: `new WebGLRenderer({ stencil: true })`.
import type { Plane, Vector3 } from 'three';
import type { HierarchyView, Plugin } from '../scene/hierarchy_view.js';
import { cutPainter } from './cut_painter.js';
import type { ClippedPainter } from '../tools/caps.js';
import { worldPlane, type CutPlane } from '../tools/planes.js';
import type { Frame } from './plugin.js';
import { Whereabouts } from './whereabouts.js';

export class Clipping implements Plugin {
  private view: HierarchyView | null = null;
  private painter: ClippedPainter | null = null;
  private planes: readonly CutPlane[] = [];
  private hasCaps = true;
  private places = new Whereabouts();

  constructor(readonly name = 'clipping') {}

  init(view: HierarchyView): void {
    this.view = view;
    this.places = new Whereabouts();
    this.painter = cutPainter(view);
    if (this.planes.length > 0) this.cut(this.planes, this.hasCaps);
  }

  /// `planes`: in the tiles' coordinates; none: the model is whole, as it is again once it is another one that lies elsewhere. `hasCaps`: where
  /// it is full.
  cut(planes: readonly CutPlane[], hasCaps = true): void {
    [this.planes, this.hasCaps] = [planes, hasCaps];
    if (this.view === null) return;
    this.places.haveChanged(this.view.manifest); // the planes are of this one
    this.view.showsInside = this.view.plugins.cuts.length > 0; // a frame comes
  }

  /// However the model stands now.
  paint({ renderer, scene, camera }: Frame): boolean {
    const { view, painter } = this;
    if (view === null || painter === null) return false;
    if (this.places.haveChanged(view.manifest) && this.planes.length > 0) this.cut([]);
    if (this.planes.length === 0) return false;
    painter.isCapped = view.closed && view.plugins.isCapped;
    painter.planes = view.plugins.cuts; // others' too: one paints for all
    painter.paint(renderer, scene, camera);
    return true;
  }

  get isCapped(): boolean {
    return this.hasCaps || this.planes.length === 0;
  }

  get cuts(): readonly Plane[] {
    const { view } = this;
    return view === null ? [] : this.planes.map((plane) => worldPlane(plane, view.surfaceMatrix));
  }

  keeps(point: Vector3): boolean {
    return this.cuts.every((plane) => plane.distanceToPoint(point) >= 0);
  }

  dispose(): void {
    if (this.planes.length > 0) this.cut([]);
    this.painter?.dispose();
    this.view = this.painter = null;
  }
}
