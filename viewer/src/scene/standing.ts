// SPDX-License-Identifier: MIT
// How a mesh stands: which of its axes is up, and how many times higher it is than wide.
import type { Vector } from '../cut/viewpoint.js';

/// `file`: as the hierarchy says.
export type Up = 'file' | 'x' | 'y' | 'z' | '-x' | '-y' | '-z';

export interface Standing {
  up: Up;
  /// Heights are multiplied by this, 1 … 100.
  stretch: number;
}

export const DEFAULT_STANDING: Standing = { up: 'file', stretch: 1 };
export const UPS: readonly Up[] = ['file', 'x', 'y', 'z', '-x', '-y', '-z'];
export const MOST_STRETCH = 100;

/// Where x, y and z of the mesh come to, for each axis that is up: rows of a turn that brings it to y.
const TURNS: Readonly<Record<Exclude<Up, 'file'>, readonly Vector[]>> = {
  x: [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
  y: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  z: [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
  '-x': [[0, 1, 0], [-1, 0, 0], [0, 0, 1]],
  '-y': [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
  '-z': [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
};

function turnOf(up: Up, zUp: boolean): readonly Vector[] {
  return TURNS[up === 'file' ? (zUp ? 'z' : 'y') : up];
}

/// In the mesh's coordinates, of length 1.
export function upwards(up: Up, zUp: boolean): Vector {
  return turnOf(up, zUp)[1];
}

/// Rows of what brings the mesh's coordinates to upright ones.
export function uprightRows({ up, stretch }: Standing, zUp: boolean): readonly Vector[] {
  return turnOf(up, zUp).map((row, axis) => (axis === 1 ? [stretch * row[0], stretch * row[1], stretch * row[2]] : row));
}

/// `current` with a change. Throws RangeError for what makes no sense.
export function changedStanding(change: Partial<Standing>, current: Standing): Standing {
  const standing = { up: change.up ?? current.up, stretch: change.stretch ?? current.stretch };
  if (!UPS.includes(standing.up)) throw new RangeError(`up is ${standing.up}, not one of ${UPS.join(', ')}`);
  if (!(standing.stretch >= 1 && standing.stretch <= MOST_STRETCH)) throw new RangeError(`stretch is ${standing.stretch}, not from 1 to ${MOST_STRETCH}`);
  return standing;
}
