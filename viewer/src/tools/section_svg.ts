// SPDX-License-Identifier: MIT
// A section as a drawing, in true size: one unit of the drawing is one of the input.
import { UNITS, type UnitName } from './units.js';
import type { Polyline } from './section.js';
import { cross, dot, unit, type Vector } from './vectors.js';

/// To the right and up in the drawing.
export type DrawingAxes = readonly [Vector, Vector];

const AXES: readonly Vector[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/// Returns the axes of a drawing in a plane of the input's coordinates; `up`: as `HierarchyView.upwards`. Across an axis the drawing has the two others' own numbers.
export function drawingAxes(normal: Vector, up: Vector): DrawingAxes {
  const along = normal.findIndex((value) => Math.abs(value) > 1 - 1e-12);
  const [one, other] = AXES.filter((_, axis) => axis !== along);
  if (along >= 0) return Math.abs(dot(one, up)) > Math.abs(dot(other, up)) ? [other, one] : [one, other];
  const right = unit(cross(up, normal));
  return [right, cross(normal, right)];
}

interface DrawingFrame {
  readonly left: number;
  readonly bottom: number;
  readonly width: number;
  readonly height: number;
}

type Flat = readonly (readonly [number, number])[];

function frameOf(lines: readonly Flat[]): DrawingFrame {
  let [left, bottom, right, top] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [x, y] of lines.flat()) {
    [left, right] = [Math.min(left, x), Math.max(right, x)];
    [bottom, top] = [Math.min(bottom, y), Math.max(top, y)];
  }
  return left <= right ? { left, bottom, width: right - left, height: top - bottom } : { left: 0, bottom: 0, width: 0, height: 0 };
}

function pathOf(line: Flat, isClosed: boolean, { left, bottom, height }: DrawingFrame): string {
  const places = line.map(([x, y]) => `${x - left} ${height - (y - bottom)}`);
  return `  <path d="M${places.join('L')}${isClosed ? 'Z' : ''}"/>`;
}

function escaped(text: string): string {
  return text.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);
}

export interface Drawing {
  readonly axes: DrawingAxes;
  readonly unit: UnitName;
  readonly title: string;
}

/// `lines`: in the input's coordinates. Millimetres tell the size where the unit is known. The lower left corner of what is drawn is at the drawing's:
/// `desc` tells what to add for the input's coordinates.
export function sectionSvg(lines: readonly Polyline[], { axes, unit: unitName, title }: Drawing): string {
  const flat = lines.map(({ points }) => points.map((point) => [dot(axes[0], point), dot(axes[1], point)] as const));
  const frame = frameOf(flat);
  const { metres, sign } = UNITS[unitName];
  const size = (length: number): string => (metres === null ? String(length) : `${length * metres * 1000}mm`);
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${size(frame.width)}" height="${size(frame.height)}" viewBox="0 0 ${frame.width} ${frame.height}">
 <title>${escaped(title)}</title>
 <desc>1 is one of the input's units (${sign}). To the right ${axes[0].join(' ')} + ${frame.left}, up ${axes[1].join(' ')} + ${frame.bottom}</desc>
 <g fill="none" stroke="#000" stroke-width="1" vector-effect="non-scaling-stroke">
${flat.map((line, i) => pathOf(line, lines[i].isClosed, frame)).join('\n')}
 </g>
</svg>
`;
}
