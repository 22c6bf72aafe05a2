// SPDX-License-Identifier: MIT
// From where an object is seen whole, with what is around it.
import { Box3, MathUtils, Vector3, type Matrix4 } from 'three';
import type { ObjectBox } from '../hierarchy/object_blocks.js';
import { CameraPose } from '../scene/camera_pose.js';
import { cornersOf, frameWhole } from '../scene/framing.js';
import { isParallel, type ViewCamera } from '../scene/projection.js';
import type { Coordinates } from './coordinates.js';

/// So many times as large as the object is what is in the picture.
const AROUND = 2.5;
/// A look that is flatter than this comes from above instead: neighbours stand in its way.
const LEAST_RISE = 0.35;
/// Degrees that a camera of parallel rays alone would see: a pose of it tells the side alone.
const ANY_ANGLE = 45;

/// The corners of a box of the input, in the world, `matrix` bringing tiles' coordinates there.
export function cornersInWorld({ min, max }: ObjectBox, coordinates: Coordinates, matrix: Readonly<Matrix4>): Vector3[] {
  const local = new Box3(new Vector3(...coordinates.fromInput(min)), new Vector3(...coordinates.fromInput(max)));
  return cornersOf(local).map((corner) => corner.applyMatrix4(matrix));
}

/// Looks at corners from the side that the camera is on now.
export function poseOfObject(corners: readonly Vector3[], now: CameraPose, camera: ViewCamera): CameraPose {
  const box = new Box3().setFromPoints([...corners]);
  const centre = box.getCenter(new Vector3());
  const around = corners.map((corner) => corner.clone().sub(centre).multiplyScalar(AROUND).add(centre));
  const back = now.forward.negate();
  back.y = Math.max(back.y, LEAST_RISE);
  back.normalize();
  const { elements: e } = camera.projectionMatrix;
  const angle = MathUtils.degToRad('fov' in camera ? camera.fov : ANY_ANGLE);
  const projection = isParallel(camera) ? 'parallel' : 'perspective';
  const { position, target } = frameWhole(around, new Box3().setFromPoints(around), [back.x, back.y, back.z], angle, e[5] / e[0], projection);
  return new CameraPose(position, target);
}
