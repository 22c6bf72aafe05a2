// SPDX-License-Identifier: MIT
// How an outline is turned and seen in its cell.
import type { FirstView } from '../../src/hierarchy/first_view.js';

/// Radians: about the upright axis, then towards the viewer.
export interface Turn {
  yaw: number;
  pitch: number;
}

/// A ball around the lines, in stored positions.
export interface Ball {
  centre: readonly [number, number, number];
  radius: number;
}

/// How the picture of a cell is moved, by parts of half a square cell, and then enlarged.
export interface Fit {
  zoom: number;
  right: number;
  up: number;
}

/// 16 numbers, column by column.
export type Matrix = readonly number[];

const FILLED = 0.92; // of a cell: as much as a preview fills
const MOST_ZOOM = 3;
const EASE = 0.7; // radians from the first turn, beyond which the ball is seen
const AS_IT_IS: Fit = { zoom: 1, right: 0, up: 0 };
const MOST_PITCH = 1.56;
const RADIANS = Math.PI / 180;
export const USUAL_TURN: Turn = { yaw: -0.6, pitch: 0.25 };
export const FOCUS = 3.2; // cotangent of half the angle of view
const MARGIN = 0.98;
/// From the eye to the ball's centre, in its radii.
export const DISTANCE = MARGIN * Math.hypot(FOCUS, 1);

function reachOf(positions: Float32Array, [x, y, z]: readonly [number, number, number]): number {
  let most = 0;
  for (let i = 0; i < positions.length; i += 3)
    most = Math.max(most, Math.hypot(positions[i] - x, positions[i + 1] - y, positions[i + 2] - z));
  return most;
}

/// Around the middle of the positions' box.
export function ballOf(positions: Float32Array): Ball {
  const least = [Infinity, Infinity, Infinity];
  const most = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; ++i) {
    least[i % 3] = Math.min(least[i % 3], positions[i]);
    most[i % 3] = Math.max(most[i % 3], positions[i]);
  }
  if (positions.length === 0) return { centre: [0, 0, 0], radius: 1 };
  const middle = (axis: number): number => least[axis] / 2 + most[axis] / 2;
  const centre = [middle(0), middle(1), middle(2)] as const;
  return { centre, radius: reachOf(positions, centre) || 1 };
}

/// Returns the turn that shows that view; null: none is better than others.
export function turnTo(view: FirstView | null): Turn {
  return view === null ? USUAL_TURN : { yaw: -view.azimuth * RADIANS, pitch: Math.min(Math.max(view.elevation * RADIANS, -MOST_PITCH), MOST_PITCH) };
}

/// To the viewer, of length 1, in upright coordinates.
export function towardsViewer({ yaw, pitch }: Turn): [number, number, number] {
  return [-Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch), Math.cos(yaw) * Math.cos(pitch)];
}

/// `turn` after a drag by (x, y), a whole turn for two widths of the cell.
export function dragged(turn: Turn, x: number, y: number, width: number): Turn {
  const scale = Math.PI / Math.max(width, 1);
  const pitch = Math.min(Math.max(turn.pitch + y * scale, -MOST_PITCH), MOST_PITCH);
  return { yaw: (turn.yaw + x * scale) % (2 * Math.PI), pitch };
}

export function multiply(a: Matrix, b: Matrix): number[] {
  const product = new Array<number>(16).fill(0);
  for (let column = 0; column < 4; ++column)
    for (let row = 0; row < 4; ++row)
      for (let k = 0; k < 4; ++k) product[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return product;
}

/// The ball becomes that of radius 1 around 0, upright.
function uprightUnit({ centre, radius }: Ball, up: 'y' | 'z'): Matrix {
  const s = 1 / radius;
  const [x, y, z] = centre.map((value) => -value * s);
  if (up === 'y') return [s, 0, 0, 0, 0, s, 0, 0, 0, 0, s, 0, x, y, z, 1];
  return [s, 0, 0, 0, 0, 0, -s, 0, 0, s, 0, 0, x, z, -y, 1];
}

function turned({ yaw, pitch }: Turn): Matrix {
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  const [d, t] = [Math.cos(pitch), Math.sin(pitch)];
  return multiply([1, 0, 0, 0, 0, d, t, 0, 0, -t, d, 0, 0, 0, 0, 1], [c, 0, -s, 0, 0, 1, 0, 0, s, 0, c, 0, 0, 0, 0, 1]);
}

/// Sees the unit ball, but for a rim that outlines seldom reach; depth from -1 at its near end to 1 at its far end.
function projection(aspect: number): Matrix {
  const narrow = Math.min(aspect, 1);
  const [near, far] = [DISTANCE - 1, DISTANCE + 1];
  const [a, b] = [(far + near) / (near - far), (2 * far * near) / (near - far)];
  const focus = FOCUS * narrow;
  return [focus / aspect, 0, 0, 0, 0, focus, 0, 0, 0, 0, a, -1, 0, 0, b - a * DISTANCE, DISTANCE];
}

/// Returns the matrix that moves and enlarges the clip space of a cell of that width by height.
export function fitMatrix({ zoom, right, up }: Fit, aspect: number): number[] {
  const narrow = Math.min(aspect, 1);
  return [zoom, 0, 0, 0, 0, zoom, 0, 0, 0, 0, 1, 0, (-zoom * right * narrow) / aspect, -zoom * up * narrow, 0, 1];
}

/// From stored positions to the clip space of a cell of that width by height.
export function cellMatrix(ball: Ball, up: 'y' | 'z', turn: Turn, aspect: number, fit: Fit = AS_IT_IS): number[] {
  return multiply(fitMatrix(fit, aspect), multiply(projection(aspect), multiply(turned(turn), uprightUnit(ball, up))));
}

/// Shows the positions in that turn as large as a preview does.
export function fitOf(positions: Float32Array, ball: Ball, up: 'y' | 'z', turn: Turn): Fit {
  if (positions.length === 0) return AS_IT_IS;
  const m = cellMatrix(ball, up, turn, 1);
  const [least, most] = [[Infinity, Infinity], [-Infinity, -Infinity]];
  for (let i = 0; i < positions.length; i += 3) {
    const at = (row: number): number => m[row] * positions[i] + m[4 + row] * positions[i + 1] + m[8 + row] * positions[i + 2] + m[12 + row];
    for (let axis = 0; axis < 2; ++axis) {
      least[axis] = Math.min(least[axis], at(axis) / at(3));
      most[axis] = Math.max(most[axis], at(axis) / at(3));
    }
  }
  const half = Math.max(most[0] - least[0], most[1] - least[1]) / 2;
  return { zoom: Math.min(FILLED / half, MOST_ZOOM), right: (most[0] + least[0]) / 2, up: (most[1] + least[1]) / 2 };
}

/// The fit of the first turn, less and less of it the further it is turned.
export function fitAt({ zoom, right, up }: Fit, first: Turn, turn: Turn): Fit {
  const t = Math.min(Math.hypot(turn.yaw - first.yaw, turn.pitch - first.pitch) / EASE, 1);
  const left = 1 - t * t * (3 - 2 * t);
  return { zoom: zoom ** left, right: right * left, up: up * left };
}
