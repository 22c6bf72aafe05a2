// SPDX-License-Identifier: MIT
// Tells whether the camera moves, and what a mesh looks like from where it is.
import { Frustum, Matrix4, Plane, Vector3, type Object3D } from 'three';
import type { Viewpoint } from '../cut/viewpoint.js';
import { isParallel, towardsViewer, type ViewCamera } from './projection.js';

export interface Viewport {
  readonly width: number;
  readonly height: number;
}

/// A camera that has not changed for this long stands still.
export const REST_MS = 200;
/// Rounding may make equal lengths differ by this factor.
const EVEN = 1 + 1e-6;

export class Motion {
  isMoving = false;
  private last = '';
  private changedAt = -Infinity;

  /// true if the picture of an unchanged scene is another one than last time.
  see(camera: ViewCamera, object: Object3D, { width, height }: Viewport, now: number): boolean {
    const state = [...camera.matrixWorld.elements, ...camera.projectionMatrix.elements, ...object.matrixWorld.elements, width, height];
    const text = state.join();
    const changed = text !== this.last;
    // The first look is no movement.
    if (changed && this.last !== '') this.changedAt = now;
    this.last = text;
    this.isMoving = now - this.changedAt < REST_MS;
    return changed;
  }
}

function planeIn(local: Matrix4, plane: Plane): readonly [number, number, number, number] {
  const { normal, constant } = plane.clone().applyMatrix4(local);
  return [normal.x, normal.y, normal.z, constant];
}

/// Lengths of the axes of an object that has no shear, in parts of the shortest; 1 where rounding alone tells them apart.
function stretchOf(object: Object3D): Viewpoint['stretch'] {
  const lengths = new Vector3().setFromMatrixScale(object.matrixWorld).toArray();
  const shortest = Math.min(...lengths);
  const [x, y, z] = lengths.map((length) => (length < EVEN * shortest ? 1 : length / shortest));
  return [x, y, z];
}

/// For each axis of the object, how much nearer to the viewer one unit along it leads, in units of the shortest.
function towardsIn(object: Object3D, camera: ViewCamera, shortest: number): Viewpoint['towards'] {
  const towards = towardsViewer(camera);
  const [x, y, z] = [0, 1, 2].map((axis) => new Vector3().setFromMatrixColumn(object.matrixWorld, axis).dot(towards) / shortest);
  return [x, y, z];
}

/// `object`: what holds the tiles; its matrices and the camera's are up to date. Scaled along its axes only.
export function viewpointOf(camera: ViewCamera, object: Object3D, { height }: Viewport): Viewpoint {
  const toLocal = object.matrixWorld.clone().invert();
  const frustum = new Frustum().setFromProjectionMatrix(
    new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse),
  );
  const eye = new Vector3().setFromMatrixPosition(camera.matrixWorld).applyMatrix4(toLocal);
  const scale = toLocal.getMaxScaleOnAxis();
  const pixels = (height * camera.projectionMatrix.elements[5]) / 2;
  const seen = isParallel(camera) ? { pixels: pixels / scale, towards: towardsIn(object, camera, 1 / scale) } : { pixels };
  return {
    eye: [eye.x, eye.y, eye.z],
    planes: frustum.planes.map((plane) => planeIn(toLocal, plane)),
    near: camera.near * scale,
    stretch: stretchOf(object),
    ...seen,
  };
}
