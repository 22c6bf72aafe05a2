// SPDX-License-Identifier: MIT
// Links: `#MODEL&px,py,pz,tx,ty,tz&NAME=VALUE…`. MODEL is the path of the hierarchy relative to the listing, and
// empty for the one model that the query names; the camera and what was chosen (appearance.ts) may be missing.
import { areNear } from '../src/farthest.js';
import type { Pose, Triple } from '../src/scene/camera_pose.js';
import { readable } from './listing.js';

export type { Pose };

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

/// Returns the choice of that name; null: it is not among them.
export function choiceOf({ choices }: Spot, name: string): string | null {
  return new URLSearchParams(choices).get(name);
}

export const NOWHERE: Spot = { pose: null, choices: '' };

const DIGITS = 12;

function rounded(value: number): number {
  return Number(value.toPrecision(DIGITS));
}

/// Returns a pose as links keep it: what is drawn from it is drawn again, to the pixel.
export function roundedPose({ position: [a, b, c], target: [d, e, f] }: Pose): Pose {
  return { position: [rounded(a), rounded(b), rounded(c)], target: [rounded(d), rounded(e), rounded(f)] };
}

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

function parseTriple(values: readonly number[]): Triple {
  return [values[0], values[1], values[2]];
}

/// Why a camera cannot stand so, in the digits that links keep; null if it can.
export function problemOfPose(position: readonly unknown[], target: readonly unknown[]): string | null {
  const isTriple = (values: readonly unknown[]): values is Triple => values.length === 3 && values.every(Number.isFinite);
  if (!isTriple(position) || !isTriple(target)) return 'position and target are three finite numbers each';
  if (!areNear([...position, ...target])) return 'position and target are too far away';
  return position.every((value, axis) => rounded(value) === rounded(target[axis])) ? 'position and target are the same point' : null;
}

/// Reads a pose; null: it is none.
function parsePose(text: string): Pose | null {
  const parts = text.split(',');
  const values = parts.map((part) => (part.trim() === '' ? NaN : Number(part)));
  const [position, target] = [values.slice(0, 3), values.slice(3)];
  return problemOfPose(position, target) === null ? { position: parseTriple(position), target: parseTriple(target) } : null;
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
  const rounded = pose === null || problemOfPose(pose.position, pose.target) !== null ? null : roundedPose(pose);
  const camera = rounded === null ? '' : `&${[...rounded.position, ...rounded.target].join(',')}`;
  return `#${linkPath(path)}${camera}${choices === '' ? '' : `&${choices}`}`;
}
