// SPDX-License-Identifier: MIT
// Where a camera may stand, in the digits that links keep.
import { areNear } from '../farthest.js';
import type { Pose, Triple } from '../scene/camera_pose.js';
import { rounded } from './kinds.js';

/// Position, then target.
export type CameraNumbers = readonly [number, number, number, number, number, number];

function isTriple(values: readonly unknown[]): values is Triple {
  return values.length === 3 && values.every(Number.isFinite);
}

/// Why a camera cannot stand so, in the digits that links keep; null if it can.
export function problemOfPose(position: readonly unknown[], target: readonly unknown[]): string | null {
  if (!isTriple(position) || !isTriple(target)) return 'position and target are three finite numbers each';
  if (!areNear([...position, ...target])) return 'position and target are too far away';
  return position.every((value, axis) => rounded(value) === rounded(target[axis])) ? 'position and target are the same point' : null;
}

/// Returns a pose as links keep it: what is drawn from it is drawn again, to the pixel.
export function roundedPose({ position: [a, b, c], target: [d, e, f] }: Pose): Pose {
  return { position: [rounded(a), rounded(b), rounded(c)], target: [rounded(d), rounded(e), rounded(f)] };
}

export function poseOf([a, b, c, d, e, f]: CameraNumbers): Pose {
  return { position: [a, b, c], target: [d, e, f] };
}

export function cameraOf({ position: [a, b, c], target: [d, e, f] }: Pose): CameraNumbers {
  return [a, b, c, d, e, f];
}
