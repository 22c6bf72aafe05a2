// SPDX-License-Identifier: MIT
// Draws the model cut open, as the clip tool says.
import { Sphere, Vector3, type PerspectiveCamera, type Scene, type WebGLRenderer } from 'three';
import type { HierarchyView } from '../../src/index.js';
import { ClippedPainter } from '../../src/tools/caps.js';
import { worldPlane, type CutPlane } from '../../src/tools/planes.js';
import type { Painter } from '../view/stage.js';

export class CutPainter implements Painter {
  private readonly clipped: ClippedPainter;
  private planes: readonly CutPlane[] = [];

  constructor(private readonly view: HierarchyView) {
    this.clipped = new ClippedPainter(view, () => {
      const { center, radius } = view.box.clone().applyMatrix4(view.matrixWorld).getBoundingSphere(new Sphere());
      return { middle: center, reach: 1.1 * radius };
    });
  }

  /// In the tiles' coordinates.
  set(planes: readonly CutPlane[], isCapped: boolean): void {
    this.planes = planes;
    this.clipped.isCapped = isCapped;
  }

  /// However the model stands now.
  paint(renderer: WebGLRenderer, scene: Scene, camera: PerspectiveCamera): void {
    this.clipped.planes = this.planes.map((plane) => worldPlane(plane, this.view.surfaceMatrix));
    this.clipped.paint(renderer, scene, camera);
  }

  keeps(point: Vector3): boolean {
    return this.clipped.planes.every((plane) => plane.distanceToPoint(point) >= 0);
  }

  dispose(): void {
    this.clipped.dispose();
  }
}
