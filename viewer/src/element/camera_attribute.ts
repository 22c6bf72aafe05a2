// SPDX-License-Identifier: MIT
// Where a camera stands and what it looks at, as an attribute: px,py,pz,tx,ty,tz.
import { areNear } from '../farthest.js';
import type { Pose } from '../scene/camera_pose.js';

/// Reads the attribute; null: it is no camera.
export function parseCamera(text: string | null): Pose | null {
  const parts = (text ?? '').split(',');
  const [a, b, c, d, e, f] = parts.map((part) => (part.trim() === '' ? NaN : Number(part)));
  const distance = Math.hypot(a - d, b - e, c - f);
  return parts.length === 6 && distance > 0 && areNear([a, b, c, d, e, f]) ? { position: [a, b, c], target: [d, e, f] } : null;
}

export function formatCamera({ position, target }: Pose): string {
  return [...position, ...target].map((value) => Number(value.toPrecision(12))).join(',');
}
