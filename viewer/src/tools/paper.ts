// SPDX-License-Identifier: MIT
// A drawing on paper: its scale, its margins, the grid of coordinates, the scale bar and the axes.
//
//     +----------------------------------+
//     |   +--------------------------+   |     all in millimetres from the upper left corner
//     |   |   what is drawn          |   |
//     |   |     |       |            |   |
//     | 20|-----+-------+------------|   |
//     |   |     |       |            |   |
//     |   +--------------------------+   |
//     |        100     120               |
//     |   ##==##==  5 m           y^_>x  |
//     |   title                          |
//     +----------------------------------+
import { roundLength } from './scale_bar.js';

export type Flat = readonly [right: number, up: number];

/// In the drawing's coordinates, units of the input.
export interface Extent {
  readonly left: number;
  readonly right: number;
  readonly bottom: number;
  readonly top: number;
}

/// An axis of the input, as a drawing has it: `sign` is -1 where it leads to the left or down.
export interface PaperAxis {
  readonly name: string;
  readonly sign: number;
  /// The drawing's coordinate is divided by it: heights may be stretched.
  readonly stretch: number;
}

export interface PaperRequest {
  /// N of 1:N.
  readonly scale: number;
  /// Metres of a unit of the input.
  readonly metres: number;
  /// The unit's sign: "m".
  readonly sign: string;
  /// To the right and up.
  readonly axes: readonly [PaperAxis, PaperAxis];
  readonly hasGrid: boolean;
  /// Lines of text below.
  readonly titles: readonly string[];
}

export interface PaperLine {
  readonly from: Flat;
  readonly to: Flat;
  readonly width: number;
}

export interface PaperText {
  /// On its base line.
  readonly at: Flat;
  readonly text: string;
  readonly anchor: 'start' | 'middle' | 'end';
  /// Is read from below to above.
  readonly isTurned?: boolean;
}

export interface Paper {
  readonly extent: Extent;
  readonly mmPerUnit: number;
  readonly width: number;
  readonly height: number;
  /// Holds the drawing, with the margin beside and above it.
  readonly inner: { readonly width: number; readonly height: number };
  readonly margin: number;
  readonly grid: readonly PaperLine[];
  readonly frame: readonly PaperLine[];
  /// The scale bar, and the axes.
  readonly bar: readonly PaperLine[];
  readonly texts: readonly PaperText[];
}

export const TEXT_HEIGHT = 2.5;
/// Millimetres of lines.
export const SECTION_WIDTH = 0.35;
export const CONTOUR_WIDTH = 0.13;
export const INDEX_WIDTH = 0.35;

const MARGIN = 12;
const BAR_ROOM = 12;
const TITLE_ROOM = 4.5; // for a line of text
const LEAST_WIDTH = 60; // titles have room
const [GRID_WIDTH, FRAME_WIDTH, BAR_WIDTH, BAR_EDGE] = [0.1, 0.2, 1.2, 0.2];
const GRID_APART = 50;
const MOST_BAR = 50;
const BAR_PARTS = 5;
const ARROW = 6;
const [LEAST, MOST] = [1, 1e5]; // of a side

/// Why there is no such drawing; null: there is.
export type PaperProblem = { readonly what: 'small' | 'large'; readonly width: number; readonly height: number } | null;

export function problemOfPaper({ width, height }: { width: number; height: number }): PaperProblem {
  const most = Math.max(width, height);
  return most < LEAST ? { what: 'small', width, height } : most <= MOST ? null : { what: 'large', width, height };
}

/// Writes a multiple of a round step with the digits that it needs.
export function coordinateText(value: number, step: number): string {
  const digits = Math.min(12, Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)));
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace('-', '') : text;
}

/// `5` of 1:5, or what it is where things are drawn larger than they are.
export function scaleText(scale: number): string {
  return scale >= 1 ? `1:${Number(scale.toPrecision(10))}` : `${Number((1 / scale).toPrecision(10))}:1`;
}

/// Multiples of a step between two values.
function stepsBetween(low: number, high: number, step: number): number[] {
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.max(0, Math.floor(high / step + 1e-9) - first + 1);
  return Array.from({ length: count }, (_, i) => Number(((first + i) * step).toPrecision(15)));
}

function around(middle: number, length: number): [number, number] {
  return [middle - length / 2, middle + length / 2];
}

/// At least as wide as the titles want it.
function widened(extent: Extent, least: number): Extent {
  if (extent.right - extent.left >= least) return extent;
  const [left, right] = around((extent.left + extent.right) / 2, least);
  return { ...extent, left, right };
}

function rectangle(left: number, top: number, width: number, height: number): PaperLine[] {
  const corners: Flat[] = [[left, top], [left + width, top], [left + width, top + height], [left, top + height]];
  return corners.map((from, i) => ({ from, to: corners[(i + 1) % 4], width: FRAME_WIDTH }));
}

interface Marks {
  readonly lines: PaperLine[];
  readonly texts: PaperText[];
}

function gridOf(extent: Extent, { axes: [right, up], scale, metres }: PaperRequest, onPaper: (place: Flat) => Flat): Marks {
  const step = roundLength(((GRID_APART / 1000) * scale) / metres);
  const marks: Marks = { lines: [], texts: [] };
  const valuesOf = ({ sign, stretch }: PaperAxis, low: number, high: number): [place: number, text: string][] =>
    stepsBetween(low / stretch, high / stretch, step).map((value) => [value * stretch, coordinateText(sign * value, step)]);
  for (const [x, text] of valuesOf(right, extent.left, extent.right)) {
    const [from, to] = [onPaper([x, extent.top]), onPaper([x, extent.bottom])];
    marks.lines.push({ from, to, width: GRID_WIDTH });
    marks.texts.push({ at: [to[0], to[1] + TEXT_HEIGHT + 1], text, anchor: 'middle' });
  }
  for (const [y, text] of valuesOf(up, extent.bottom, extent.top)) {
    const [from, to] = [onPaper([extent.left, y]), onPaper([extent.right, y])];
    marks.lines.push({ from, to, width: GRID_WIDTH });
    marks.texts.push({ at: [from[0] - 1, from[1]], text, anchor: 'middle', isTurned: true });
  }
  return marks;
}

/// Black and white in turn, from the left, at `at`.
function barOf([left, top]: Flat, { scale, metres, sign }: PaperRequest): Marks {
  const mmPerUnit = (1000 * metres) / scale;
  const length = roundLength(MOST_BAR / mmPerUnit);
  const part = (length * mmPerUnit) / BAR_PARTS;
  const lines: PaperLine[] = [0, 2, 4].map((i) => ({ from: [left + i * part, top], to: [left + (i + 1) * part, top], width: BAR_WIDTH }));
  for (const side of [-1, 1]) {
    const y = top + (side * (BAR_WIDTH - BAR_EDGE)) / 2;
    lines.push({ from: [left, y], to: [left + BAR_PARTS * part, y], width: BAR_EDGE });
  }
  const text = (i: number, value: string, anchor: PaperText['anchor']): PaperText => ({ at: [left + i * part, top + BAR_WIDTH + TEXT_HEIGHT], text: value, anchor });
  return { lines, texts: [text(0, '0', 'start'), text(BAR_PARTS, `${length} ${sign}`, 'middle')] };
}

function nameOf({ name, sign }: PaperAxis): string {
  return sign < 0 ? `−${name}` : name;
}

/// Two arrows to where the axes lead, which meet at `at`.
function axesOf([x, y]: Flat, [right, up]: PaperRequest['axes']): Marks {
  const line = (from: Flat, to: Flat): PaperLine => ({ from, to, width: FRAME_WIDTH });
  const [tip, top]: Flat[] = [[x + ARROW, y], [x, y - ARROW]];
  const heads: PaperLine[] = [line(tip, [tip[0] - 1.2, y - 0.7]), line(tip, [tip[0] - 1.2, y + 0.7]), line(top, [x - 0.7, top[1] + 1.2]), line(top, [x + 0.7, top[1] + 1.2])];
  const texts: PaperText[] = [{ at: [tip[0] + 1, y + 0.8], text: nameOf(right), anchor: 'start' }, { at: [x - 1, top[1] + 1.5], text: nameOf(up), anchor: 'end' }];
  return { lines: [line([x, y], tip), line([x, y], top), ...heads], texts };
}

/// Returns the paper on which what lies in the extent has its scale. Require: problemOfPaper() of it is null.
export function paperFor(wanted: Extent, request: PaperRequest): Paper {
  const mmPerUnit = (1000 * request.metres) / request.scale;
  const extent = widened(wanted, LEAST_WIDTH / mmPerUnit);
  const inner = { width: (extent.right - extent.left) * mmPerUnit, height: (extent.top - extent.bottom) * mmPerUnit };
  const [width, below] = [inner.width + 2 * MARGIN, MARGIN + inner.height + TEXT_HEIGHT + 2];
  const place = ([x, y]: Flat): Flat => [MARGIN + (x - extent.left) * mmPerUnit, MARGIN + (extent.top - y) * mmPerUnit];
  const grid = request.hasGrid ? gridOf(extent, request, place) : { lines: [], texts: [] };
  const [bar, axes] = [barOf([MARGIN, below + 4], request), axesOf([width - MARGIN - ARROW - 4, below + 8], request.axes)];
  const titles = request.titles.map((text, i): PaperText => ({ at: [MARGIN, below + BAR_ROOM + TITLE_ROOM * (i + 0.7)], text, anchor: 'start' }));
  return {
    extent, mmPerUnit, inner, margin: MARGIN, width, height: below + BAR_ROOM + TITLE_ROOM * titles.length + 3,
    grid: grid.lines, frame: rectangle(MARGIN, MARGIN, inner.width, inner.height), bar: [...bar.lines, ...axes.lines], texts: [...grid.texts, ...bar.texts, ...axes.texts, ...titles],
  };
}

/// Returns the place on the paper of the drawing's coordinates.
export function onPaper({ extent, margin, mmPerUnit }: Paper, [x, y]: Flat): Flat {
  return [margin + (x - extent.left) * mmPerUnit, margin + (extent.top - y) * mmPerUnit];
}
