// SPDX-License-Identifier: MIT
// A model's outline as the gallery turns it.
import type { Outline } from '../../src/hierarchy/outline.js';
import { ballOf, fitOf, turnTo, type Ball, type Fit, type Turn } from './layout.js';

export interface Shape {
  /// Six numbers a segment.
  ends: Float32Array;
  /// From this segment on they draw the form; those before are where sectors meet, and fainter.
  formBegin: number;
  ball: Ball;
  up: 'y' | 'z';
  /// The turn in which it is seen first.
  first: Turn;
  /// Shows it then as large as its preview is.
  fit: Fit;
}

function endsOf({ positions, segments }: Outline): Float32Array {
  const ends = new Float32Array(3 * segments.length);
  segments.forEach((vertex, i) => { ends.set(positions.subarray(3 * vertex, 3 * vertex + 3), 3 * i); });
  return ends;
}

export function shapeOf(outline: Outline): Shape {
  const { positions, segments, formSegments, up, firstView } = outline;
  const [ball, first] = [ballOf(positions), turnTo(firstView)];
  return { ends: endsOf(outline), formBegin: segments.length / 2 - formSegments, ball, up, first, fit: fitOf(positions, ball, up, first) };
}
