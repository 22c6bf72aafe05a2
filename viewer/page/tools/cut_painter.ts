// Draws the model cut open, as the clip tool says.
import { Sphere, Vector3, type PerspectiveCamera, type Scene, type WebGLRenderer } from 'three';
import type { HierarchyView } from '../../src/index.js';
import { ClippedPainter } from '../../src/tools/caps.js';
import { worldPlane, type CutPlane } from '../../src/tools/planes.js';
import type { Painter } from '../view/stage.js';

export class CutPainter implements Painter {
  private readonly clipped: ClippedPainter;

  constructor(private readonly view: HierarchyView) {
    this.clipped = new ClippedPainter(view, () => {
      const { center, radius } = view.box.clone().applyMatrix4(view.matrixWorld).getBoundingSphere(new Sphere());
      return { middle: center, reach: 1.1 * radius };
    });
  }

  /// In the tiles' coordinates.
  set(planes: readonly CutPlane[], isCapped: boolean): void {
    this.clipped.planes = planes.map((plane) => worldPlane(plane, this.view.surfaceMatrix));
    this.clipped.isCapped = isCapped;
  }

  paint(renderer: WebGLRenderer, scene: Scene, camera: PerspectiveCamera): void {
    this.clipped.paint(renderer, scene, camera);
  }

  keeps(point: Vector3): boolean {
    return this.clipped.planes.every((plane) => plane.distanceToPoint(point) >= 0);
  }

  dispose(): void {
    this.clipped.dispose();
  }
}
