// SPDX-License-Identifier: MIT
// Two projections: rays that meet in the eye, and parallel ones, whose pictures have one scale at all depths, as drawings have.
//
//        perspective               parallel
//          \     /                 |     |
//           \   /   target         |     |   target: here a picture of either kind is
//            \ /                   |     |   equally high, so that one may change to the other
//            eye                   +-eye-+
import { PerspectiveCamera, Vector3, type OrthographicCamera } from 'three';

export type Projection = 'perspective' | 'parallel';

/// A view is seen by either camera of three.
export type ViewCamera = PerspectiveCamera | OrthographicCamera;

/// Tells whether a camera's rays are parallel; its projection is up to date.
export function isParallel({ projectionMatrix: { elements } }: Pick<ViewCamera, 'projectionMatrix'>): boolean {
  return elements[11] === 0;
}

/// Returns the direction to the viewer in the world, of length 1; exact for parallel rays.
export function towardsViewer({ matrixWorld }: Pick<ViewCamera, 'matrixWorld'>): Vector3 {
  return new Vector3().setFromMatrixColumn(matrixWorld, 2).normalize();
}

/// Returns how high the picture is at the target of a camera that sees the angle, in radians, from its lower to its upper edge.
export function heightAt(distance: number, angle: number): number {
  return 2 * distance * Math.tan(angle / 2);
}

/// A camera that can change its projection; lights and plug-ins keep it.
export class SwitchingCamera extends PerspectiveCamera {
  /// Rays are parallel, and the picture is so high, in units of the world. Null: they meet in the eye.
  parallelHeight: number | null = null;

  override updateProjectionMatrix(): void {
    const height = (this.parallelHeight as number | null | undefined) ?? null; // three's constructor asks before there is one
    Object.assign(this, { isPerspectiveCamera: height === null, isOrthographicCamera: height !== null });
    if (height === null) super.updateProjectionMatrix();
    else this.project(height * this.aspect, height);
  }

  /// A part of the picture where three wants one.
  private project(width: number, height: number): void {
    const part = this.view?.enabled ? this.view : { fullWidth: 1, fullHeight: 1, offsetX: 0, offsetY: 0, width: 1, height: 1 };
    const [left, top] = [width * (part.offsetX / part.fullWidth - 0.5), height * (0.5 - part.offsetY / part.fullHeight)];
    const [right, bottom] = [left + (width * part.width) / part.fullWidth, top - (height * part.height) / part.fullHeight];
    this.projectionMatrix.makeOrthographic(left, right, top, bottom, this.near, this.far, this.coordinateSystem);
    this.projectionMatrixInverse.copy(this.projectionMatrix).invert();
  }
}
