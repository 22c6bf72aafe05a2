// SPDX-License-Identifier: MIT
// Links: `#MODEL&px,py,pz,tx,ty,tz&NAME=VALUE…`. MODEL is the path of the hierarchy relative to the listing, and
// empty for the one model that the query names; the camera and what was chosen (src/view/view_table.ts) may be missing.
import type { Pose } from '../src/scene/camera_pose.js';
import { cameraOf, poseOf, problemOfPose, roundedPose } from '../src/view/pose.js';
import { writeLink } from '../src/view/view_link.js';
import { VIEW_TABLE } from '../src/view/view_table.js';
import { readable } from './path_name.js';

export { problemOfPose, roundedPose, type Pose };

/// A link keeps this of a view.
export interface Spot {
  /// Null: all of the model.
  pose: Pose | null;
  /// NAME=VALUE of what was chosen, with & between.
  choices: string;
}

export interface Address extends Spot {
  path: string;
}

export const NOWHERE: Spot = { pose: null, choices: '' };

/// A model's path as links write it, an absolute one too. Listings may escape more or less of it: it is the same model then.
export function linkPath(path: string): string {
  return path.split(/([/:])/).map((part, i) => (i % 2 === 1 ? part : encodeURIComponent(readable(part)))).join('');
}

/// Reads a path; null: it is none.
function parsePath(text: string): string | null {
  try {
    decodeURIComponent(text);
  } catch {
    return null;
  }
  return linkPath(text);
}

/// Reads a pose; null: it is none.
function parsePose(text: string): Pose | null {
  const camera = VIEW_TABLE.camera.kind.parse([text]);
  return camera && poseOf(camera);
}

/// `hash` as `location.hash` has it; the path is as linkPath() has it. Null if it names no model.
export function parseAddress(hash: string): Address | null {
  const text = hash.startsWith('#') ? hash.slice(1) : hash;
  if (text === '') return null;
  const [first, ...others] = text.split('&');
  const path = parsePath(first);
  const pose = others.find((part) => !part.includes('='));
  return path === null ? null : { path, pose: pose === undefined ? null : parsePose(pose), choices: others.filter((part) => part.includes('=')).join('&') };
}

/// Writes what `parseAddress` reads again, with twelve digits a number; without the camera, if none can stand so.
export function formatAddress({ path, pose, choices }: Address): string {
  const camera = pose === null || problemOfPose(pose.position, pose.target) !== null ? '' : writeLink({ camera: cameraOf(pose) });
  return `#${[linkPath(path), camera, choices].filter((text, i) => i === 0 || text !== '').join('&')}`;
}
