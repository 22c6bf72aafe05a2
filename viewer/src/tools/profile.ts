// SPDX-License-Identifier: MIT
// The surface's heights along a line, as it is cut upright.
import type { DrawnTile } from '../scene/surface.js';
import { planeThrough } from './planes.js';
import { sectionOf, type Polyline } from './section.js';
import { cross, dot, length, scale, subtract, unit, type Vector } from './vectors.js';

export interface ProfilePoint {
  /// Along the line's plan, from its beginning.
  readonly distance: number;
  /// In the tiles' coordinates.
  readonly point: Vector;
}

/// One behind the other on the surface.
export type Profile = readonly ProfilePoint[];

function mixed(a: Vector, b: Vector, part: number): Vector {
  return [0, 1, 2].map((axis) => a[axis] + (b[axis] - a[axis]) * part) as unknown as Vector;
}

/// Returns the part of a line between the distances 0 and `most`, in pieces, in the direction in which distances grow.
function within({ points, isClosed }: Polyline, distanceOf: (point: Vector) => number, most: number): ProfilePoint[][] {
  const walked = isClosed ? [...points, points[0]] : points;
  const pieces: ProfilePoint[][] = [];
  let piece: ProfilePoint[] = [];
  const end = (): void => {
    if (piece.length > 1) pieces.push(piece[0].distance <= piece[piece.length - 1].distance ? piece : piece.reverse());
    piece = [];
  };
  for (let i = 1; i < walked.length; ++i) {
    const [a, b] = [walked[i - 1], walked[i]];
    const [from, to] = [distanceOf(a), distanceOf(b)];
    // Parts of the segment at which it enters and leaves.
    const isInside = from >= 0 && from <= most;
    const ends = from === to ? [0, isInside ? 1 : -1] : [-from / (to - from), (most - from) / (to - from)].sort((one, other) => one - other);
    const [first, last] = [Math.max(0, ends[0]), Math.min(1, ends[1])];
    if (!(first <= last)) {
      end();
      continue;
    }
    const at = (part: number): ProfilePoint => ({ distance: Math.min(Math.max(from + (to - from) * part, 0), most), point: part === 0 ? a : part === 1 ? b : mixed(a, b, part) });
    if (first > 0 || piece.length === 0) {
      end();
      piece.push(at(first));
    }
    piece.push(at(last));
    if (last < 1) end();
  }
  end();
  return pieces;
}

/// `line`: points in the tiles' coordinates, each part is cut upright of its own; a part without a plan has no profile. `up`: of length 1. A closed
/// surface has several profiles above each other. O(triangles of the tiles that the parts' planes cross).
export function profileOf(surface: readonly DrawnTile[], line: readonly Vector[], up: Vector): Profile[] {
  const profiles: Profile[] = [];
  let before = 0;
  for (let i = 1; i < line.length; ++i) {
    const level = (point: Vector): Vector => subtract(point, scale(up, dot(point, up)));
    const plan = subtract(level(line[i]), level(line[i - 1]));
    const most = length(plan);
    if (most === 0) continue;
    const along = unit(plan);
    const start = dot(line[i - 1], along);
    const plane = planeThrough(line[i - 1], unit(cross(up, along)));
    const pieces = sectionOf(surface, plane).flatMap((cut) => within(cut, (point) => dot(point, along) - start, most));
    const shift = before;
    profiles.push(...pieces.map((piece) => piece.map(({ distance, point }) => ({ distance: distance + shift, point }))));
    before += most;
  }
  return profiles;
}

/// Spreadsheets read it: each profile has a number; `toInput`: from the tiles' coordinates; `up`: in the input's.
export function profileCsv(profiles: readonly Profile[], toInput: (point: Vector) => Vector, up: Vector): string {
  const rows = profiles.flatMap((profile, i) => profile.map(({ distance, point }) => {
    const at = toInput(point);
    return [i + 1, distance, dot(at, up), ...at].join(',');
  }));
  return `${['profile,distance,height,x,y,z', ...rows].join('\r\n')}\r\n`;
}

/// For sectionSvg() with PROFILE_AXES: distances to the right, heights up.
export function profileLines(profiles: readonly Profile[], toInput: (point: Vector) => Vector, up: Vector): Polyline[] {
  return profiles.map((profile) => ({ points: profile.map(({ distance, point }): Vector => [distance, dot(toInput(point), up), 0]), isClosed: false }));
}

export const PROFILE_AXES: readonly [Vector, Vector] = [[1, 0, 0], [0, 1, 0]];
