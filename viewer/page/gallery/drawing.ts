// SPDX-License-Identifier: MIT
// Draws an outline into a canvas, fainter towards its back.
import { cellMatrix, fitAt, type Turn } from './layout.js';
import type { Shape } from './shape.js';

/// Where there is no graphics card, thousands of short lines take 15 times as long in the browser's stand-in for one.
const ON_PROCESSOR: CanvasRenderingContext2DSettings = { willReadFrequently: true };
const LINE_WIDTH = 1.3;
const MOST_RATIO = 2;
const SHADES = 8; // from the front to the back; each is one stroke
const FAINTEST = 0.16;
const BESIDE_FORM = 0.3; // how strong lines of sectors are where others draw the form
const [NEAR, FAR] = [0.25, 0.85]; // depths where lines begin to fade and have done so

/// The first segment, and the one after the last.
type Segments = readonly [number, number];

/// Four numbers a segment, in pixels, and its shade.
interface Projected {
  ends: Float32Array;
  shades: Uint8Array;
}

function fading(depth: number): number {
  const t = Math.min(Math.max((depth - NEAR) / (FAR - NEAR), 0), 1);
  return t * t * (3 - 2 * t);
}

/// `ends`: six numbers a segment. A segment has the shade of its middle.
function project(ends: Float32Array, m: readonly number[], width: number, height: number): Projected {
  const count = ends.length / 6;
  const projected = { ends: new Float32Array(4 * count), shades: new Uint8Array(count) };
  for (let i = 0; i < count; ++i) {
    let depth = 0;
    for (let end = 0; end < 2; ++end) {
      const [x, y, z] = [ends[6 * i + 3 * end], ends[6 * i + 3 * end + 1], ends[6 * i + 3 * end + 2]];
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      projected.ends[4 * i + 2 * end] = ((m[0] * x + m[4] * y + m[8] * z + m[12]) / w + 1) * 0.5 * width;
      projected.ends[4 * i + 2 * end + 1] = (1 - (m[1] * x + m[5] * y + m[9] * z + m[13]) / w) * 0.5 * height;
      depth += (m[2] * x + m[6] * y + m[10] * z + m[14]) / w;
    }
    projected.shades[i] = Math.min(Math.floor(fading(depth / 4 + 0.5) * SHADES), SHADES - 1);
  }
  return projected;
}

function strokeShade(context: CanvasRenderingContext2D, { ends, shades }: Projected, shade: number, [begin, end]: Segments, strength: number): void {
  context.globalAlpha = strength * (1 - (1 - FAINTEST) * (shade / (SHADES - 1)));
  context.beginPath();
  for (let i = begin; i < end; ++i) {
    if (shades[i] !== shade) continue;
    context.moveTo(ends[4 * i], ends[4 * i + 1]);
    context.lineTo(ends[4 * i + 2], ends[4 * i + 3]);
  }
  context.stroke();
}

function stroke(context: CanvasRenderingContext2D, projected: Projected, range: Segments, strength: number): void {
  for (let shade = SHADES - 1; shade >= 0; --shade) strokeShade(context, projected, shade, range, strength);
}

/// With as many pixels as the canvas has on the page; nothing happens while it has none.
export function drawOutline(canvas: HTMLCanvasElement, shape: Shape, turn: Turn, colour: string): void {
  const ratio = Math.min(devicePixelRatio, MOST_RATIO);
  const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
  const context = canvas.getContext('2d', ON_PROCESSOR);
  if (width === 0 || height === 0 || context === null) return;
  Object.assign(canvas, { width, height }); // clears it
  context.lineWidth = LINE_WIDTH * ratio;
  context.strokeStyle = colour;
  const projected = project(shape.ends, cellMatrix(shape.ball, shape.up, turn, width / height, fitAt(shape.fit, shape.first, turn)), width, height);
  const count = projected.shades.length;
  stroke(context, projected, [0, shape.formBegin], shape.formBegin < count ? BESIDE_FORM : 1);
  stroke(context, projected, [shape.formBegin, count], 1);
}
