// SPDX-License-Identifier: MIT
// Lines of a drawing: sections and contours in its coordinates, each on a layer.
import type { Contour } from './contours.js';
import type { Flat } from './paper.js';
import { coordinateText } from './paper.js';
import type { Polyline } from './section.js';
import { dot, type Vector } from './vectors.js';

export type LineLayer = 'SECTION' | 'CONTOUR' | 'CONTOUR_INDEX';

export interface DrawnLine {
  readonly layer: LineLayer;
  readonly points: readonly Flat[];
  readonly isClosed: boolean;
  /// Above the drawing's plane.
  readonly height: number;
  /// Stands at the middle of the line.
  readonly label?: string;
}

/// To the right, up, and to who looks, in the input's coordinates.
export type DrawingFrame = readonly [right: Vector, up: Vector, towards: Vector];

export type ToInput = (point: Vector) => Vector;

function flattened({ points }: Polyline, [right, up]: DrawingFrame, toInput: ToInput): Flat[] {
  return points.map((point) => {
    const at = toInput(point);
    return [dot(right, at), dot(up, at)];
  });
}

/// `height`: of the plane that cuts.
export function sectionLines(lines: readonly Polyline[], frame: DrawingFrame, toInput: ToInput, height: number): DrawnLine[] {
  return lines.map((line) => ({ layer: 'SECTION', points: flattened(line, frame, toInput), isClosed: line.isClosed, height }));
}

export function contourLines(contours: readonly Contour[], interval: number, frame: DrawingFrame, toInput: ToInput): DrawnLine[] {
  return contours.flatMap(({ height, isIndex, lines }) => lines.map((line): DrawnLine => {
    const label = isIndex ? { label: coordinateText(height, interval) } : {};
    return { layer: isIndex ? 'CONTOUR_INDEX' : 'CONTOUR', points: flattened(line, frame, toInput), isClosed: line.isClosed, height, ...label };
  }));
}

/// The points with the first one again where a line is closed.
export function walked<Point>(points: readonly Point[], isClosed: boolean): readonly Point[] {
  return isClosed ? [...points, points[0]] : points;
}

export function lengthOfLine({ points, isClosed }: Pick<DrawnLine, 'points' | 'isClosed'>): number {
  const all = walked(points, isClosed);
  return all.reduce((sum, [x, y], i) => (i === 0 ? 0 : sum + Math.hypot(x - all[i - 1][0], y - all[i - 1][1])), 0);
}

export interface MiddleOfLine {
  readonly at: Flat;
  /// Along the line, to the right: a text can be read. Of length 1.
  readonly along: Flat;
}

/// Null: the line has no length.
export function middleOf(line: Pick<DrawnLine, 'points' | 'isClosed'>): MiddleOfLine | null {
  const all = walked(line.points, line.isClosed);
  let left = lengthOfLine(line) / 2;
  for (let i = 1; i < all.length; ++i) {
    const [[x, y], [toX, toY]] = [all[i - 1], all[i]];
    const step = Math.hypot(toX - x, toY - y);
    const sign = toX < x ? -1 : 1;
    if (step > 0 && step >= left) return { at: [x + ((toX - x) * left) / step, y + ((toY - y) * left) / step], along: [(sign * (toX - x)) / step, (sign * (toY - y)) / step] };
    left -= step;
  }
  return null;
}
