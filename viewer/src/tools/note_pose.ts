// SPDX-License-Identifier: MIT
// From where a note is looked at.
import { CameraPose } from '../scene/camera_pose.js';
import type { Note } from './note.js';
import type { Places } from './places.js';

/// As it wants to be seen, else along the way that the camera looks, from no farther than `most`.
export function poseOfNote({ at, view }: Note, places: Places, now: CameraPose, most: number): CameraPose {
  if (view) return new CameraPose(places.toWorld(view.position), places.toWorld(view.target));
  const target = places.toWorld(at);
  return new CameraPose(target.clone().addScaledVector(now.forward, -Math.min(now.distance, most)), target);
}
