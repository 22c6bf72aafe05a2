// A model's outline as the gallery turns it.
import type { Outline } from '../../src/hierarchy/outline.js';
import { ballOf, turnTo, type Ball, type Turn } from './layout.js';

export interface Shape {
  /// Six numbers a segment.
  ends: Float32Array;
  ball: Ball;
  up: 'y' | 'z';
  /// As it is seen first.
  first: Turn;
}

function endsOf({ positions, segments }: Outline): Float32Array {
  const ends = new Float32Array(3 * segments.length);
  segments.forEach((vertex, i) => { ends.set(positions.subarray(3 * vertex, 3 * vertex + 3), 3 * i); });
  return ends;
}

export function shapeOf(outline: Outline): Shape {
  return { ends: endsOf(outline), ball: ballOf(outline.positions), up: outline.up, first: turnTo(outline.firstView) };
}
