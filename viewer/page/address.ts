// Links: `#MODEL&px,py,pz,tx,ty,tz`. MODEL is the path of the hierarchy relative to the listing, and
// empty for the one model that the query names; the camera may be missing.

export type Triple = readonly [number, number, number];

/// Where the camera is and what it looks at, in the model's upright coordinates.
export interface Pose {
  position: Triple;
  target: Triple;
}

export interface Address {
  path: string;
  pose: Pose | null;
}

const DIGITS = 12;

function rounded(value: number): number {
  return Number(value.toPrecision(DIGITS));
}

/// What a link keeps of a pose: what is drawn from it is drawn again, to the pixel.
export function roundedPose({ position: [a, b, c], target: [d, e, f] }: Pose): Pose {
  return { position: [rounded(a), rounded(b), rounded(c)], target: [rounded(d), rounded(e), rounded(f)] };
}

function formatPath(path: string): string {
  return path.split('/').map(encodeURIComponent).join('/');
}

/// Null of what is no path.
function parsePath(text: string): string | null {
  try {
    return decodeURIComponent(text);
  } catch {
    return null;
  }
}

function parseTriple(values: readonly number[]): Triple {
  return [values[0], values[1], values[2]];
}

/// Why a camera cannot stand so, in the digits that links keep; null if it can.
export function problemOfPose(position: readonly unknown[], target: readonly unknown[]): string | null {
  const isTriple = (values: readonly unknown[]): values is Triple => values.length === 3 && values.every(Number.isFinite);
  if (!isTriple(position) || !isTriple(target)) return 'position and target are three finite numbers each';
  const way = position.reduce((sum, value, axis) => sum + (rounded(value) - rounded(target[axis])) ** 2, 0);
  if (way === 0) return 'position and target are the same point';
  return Number.isFinite(way) ? null : 'position and target are too far from each other';
}

/// Null of what is no pose.
function parsePose(text: string): Pose | null {
  const parts = text.split(',');
  const values = parts.map((part) => (part.trim() === '' ? NaN : Number(part)));
  const [position, target] = [values.slice(0, 3), values.slice(3)];
  return problemOfPose(position, target) === null ? { position: parseTriple(position), target: parseTriple(target) } : null;
}

/// `hash` as `location.hash` has it. Null if it names no model.
export function parseAddress(hash: string): Address | null {
  const text = hash.startsWith('#') ? hash.slice(1) : hash;
  if (text === '') return null;
  const end = text.indexOf('&');
  const path = parsePath(end < 0 ? text : text.slice(0, end));
  return path === null ? null : { path, pose: end < 0 ? null : parsePose(text.slice(end + 1)) };
}

/// What `parseAddress` reads again, with twelve digits a number.
export function formatAddress({ path, pose }: Address): string {
  if (pose === null) return `#${formatPath(path)}`;
  const { position, target } = roundedPose(pose);
  return `#${formatPath(path)}&${[...position, ...target].join(',')}`;
}
