// SPDX-License-Identifier: MIT
// From where an object is seen whole, with what is around it.
import { Box3, Vector3, type Matrix4, type PerspectiveCamera } from 'three';
import type { ObjectBox } from '../hierarchy/object_blocks.js';
import { CameraPose } from '../scene/camera_pose.js';
import { cornersOf, frameWhole } from '../scene/framing.js';
import type { Coordinates } from './coordinates.js';

/// So many times as large as the object is what is in the picture.
const AROUND = 2.5;
/// A look that is flatter than this comes from above instead: neighbours stand in its way.
const LEAST_RISE = 0.35;

/// The corners of a box of the input, in the world, `matrix` bringing tiles' coordinates there.
export function cornersInWorld({ min, max }: ObjectBox, coordinates: Coordinates, matrix: Readonly<Matrix4>): Vector3[] {
  const local = new Box3(new Vector3(...coordinates.fromInput(min)), new Vector3(...coordinates.fromInput(max)));
  return cornersOf(local).map((corner) => corner.applyMatrix4(matrix));
}

/// Looks at corners from the side that the camera is on now.
export function poseOfObject(corners: readonly Vector3[], now: CameraPose, camera: PerspectiveCamera): CameraPose {
  const box = new Box3().setFromPoints([...corners]);
  const centre = box.getCenter(new Vector3());
  const around = corners.map((corner) => corner.clone().sub(centre).multiplyScalar(AROUND).add(centre));
  const back = now.forward.negate();
  back.y = Math.max(back.y, LEAST_RISE);
  back.normalize();
  const { position, target } = frameWhole(around, new Box3().setFromPoints(around), [back.x, back.y, back.z], (camera.fov * Math.PI) / 180, camera.aspect);
  return new CameraPose(position, target);
}
