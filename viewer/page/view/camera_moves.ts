// SPDX-License-Identifier: MIT
// Moves a camera that looks at a target, upright. Nothing here keeps what it is given.
import { Vector3, type Box3 } from 'three';
import { CameraPose } from '../../src/scene/camera_pose.js';
import { axesOf, frameWhole } from '../../src/scene/framing.js';
import { heightAt, type Projection } from '../../src/scene/projection.js';

/// Radians, from the lower to the upper edge of the picture.
export const VIEW_ANGLE = Math.PI / 4;

const STEEPEST = 0.01; // radians from straight up or down

/// Around the target; radians to the right and up.
export function turn(pose: CameraPose, right: number, up: number): CameraPose {
  const offset = pose.position.clone().sub(pose.target);
  const length = offset.length();
  const steepness = Math.acos(Math.min(Math.max(offset.y / length, -1), 1));
  const wanted = Math.min(Math.max(steepness - up, STEEPEST), Math.PI - STEEPEST);
  const around = Math.atan2(offset.x, offset.z) + right;
  offset.set(Math.sin(wanted) * Math.sin(around), Math.cos(wanted), Math.sin(wanted) * Math.cos(around));
  return new CameraPose(offset.multiplyScalar(length).add(pose.target), pose.target.clone());
}

/// Moves along the picture, by parts of its height of what lies at `depth` in front of the camera.
export function pan(pose: CameraPose, right: number, up: number, depth: number): CameraPose {
  const axes = axesOf(pose.forward);
  const height = heightAt(depth, VIEW_ANGLE);
  const move = axes.right.multiplyScalar(right * height).addScaledVector(axes.up, up * height);
  return new CameraPose(pose.position.clone().add(move), pose.target.clone().add(move));
}

/// Scales all distances to `point`, which stays where it is in the picture.
export function zoom(pose: CameraPose, point: Vector3, factor: number): CameraPose {
  const scaled = (from: Vector3): Vector3 => from.clone().sub(point).multiplyScalar(factor).add(point);
  return new CameraPose(scaled(pose.position), scaled(pose.target));
}

/// The same picture, to be turned around what lies at `depth`.
export function retarget(pose: CameraPose, depth: number): CameraPose {
  return new CameraPose(pose.position.clone(), pose.forward.multiplyScalar(depth).add(pose.position));
}

/// The same picture of parallel rays, to be turned around what lies at `depth`: it is as large wherever the camera is along them.
export function slide(pose: CameraPose, depth: number): CameraPose {
  const move = pose.forward.multiplyScalar(depth - pose.distance);
  return new CameraPose(pose.position.clone().add(move), pose.target.clone().add(move));
}

export function depthOf(pose: CameraPose, point: Vector3): number {
  return point.clone().sub(pose.position).dot(pose.forward);
}

/// All of a shape within the box in a picture of that aspect. `direction`: to the viewer, of length 1; null: none is better than others.
/// `points`: of the shape; none: the box's corners. `angle`: of the picture's height.
export function wholeView(box: Box3, aspect: number, direction: readonly [number, number, number] | null = null, points: Iterable<Vector3> = [], projection: Projection = 'perspective', angle = VIEW_ANGLE): CameraPose {
  const { position, target } = frameWhole(points, box, direction, angle, aspect, projection);
  return new CameraPose(position, target);
}

/// Near and far plane that hold the box, and whatever is near the target.
export function depthRange(pose: CameraPose, box: Box3): { near: number; far: number } {
  const radius = box.getSize(new Vector3()).length() * 0.52;
  const away = pose.position.distanceTo(box.getCenter(new Vector3()));
  const near = Math.max(away - radius, pose.distance * 0.02);
  return { near, far: Math.max(away + radius, near * 2) };
}

/// Where a camera of parallel rays stands, with its planes: outside of the box, which it holds, wherever the pose is along its rays.
export function parallelStand(pose: CameraPose, box: Box3): { position: Vector3; near: number; far: number } {
  const radius = Math.max(box.getSize(new Vector3()).length() * 0.52, pose.distance * 0.02);
  const forward = pose.forward;
  const middle = box.getCenter(new Vector3()).sub(pose.target).dot(forward);
  return { position: pose.target.clone().addScaledVector(forward, middle - 2 * radius), near: radius, far: 3 * radius };
}

/// Part `t` of the way from `a` to `b`: distances grow by equal factors in equal times.
export function between(a: CameraPose, b: CameraPose, t: number): CameraPose {
  const target = a.target.clone().lerp(b.target, t);
  const distance = a.distance * (b.distance / a.distance) ** t;
  const direction = a.forward.lerp(b.forward, t);
  if (direction.lengthSq() < 1e-6) direction.copy(b.forward);
  return new CameraPose(target.clone().addScaledVector(direction.normalize(), -distance), target);
}
