// SPDX-License-Identifier: MIT
// Paints what a drawing on paper has besides the model, part by part, over a picture.
import { LABEL_HEIGHT, LEAST_LABELLED } from './drawing_svg.js';
import { lengthOfLine, middleOf, type DrawnLine } from './line_drawing.js';
import { CONTOUR_WIDTH, INDEX_WIDTH, onPaper, SECTION_WIDTH, TEXT_HEIGHT, type Flat, type Paper, type PaperLine } from './paper.js';
import type { DrawPart, Part } from './screenshot.js';

const INCH = 25.4; // millimetres
const WIDTHS = { SECTION: SECTION_WIDTH, CONTOUR: CONTOUR_WIDTH, CONTOUR_INDEX: INDEX_WIDTH };
const [INK, BROWN, GREY] = ['#000', '#84532b', 'rgba(0, 0, 0, 0.45)'];
const FONT = 'sans-serif';

/// Pixels of a millimetre.
export function pixelsPerMm(dotsPerInch: number): number {
  return dotsPerInch / INCH;
}

/// Whole pixels: the upper left corner lies on one.
export function sizeOfPaper({ width, height }: Paper, dotsPerInch: number): { width: number; height: number } {
  const pixels = pixelsPerMm(dotsPerInch);
  return { width: Math.ceil(width * pixels), height: Math.ceil(height * pixels) };
}

type Context = OffscreenCanvasRenderingContext2D;

/// In millimetres, whatever the context is scaled to.
class Painter {
  constructor(private readonly context: Context, private readonly paper: Paper) {}

  /// Nothing of the model is seen beyond the frame.
  margins(): void {
    const { context, paper: { width, height, margin, inner } } = this;
    context.fillStyle = '#fff';
    const [right, bottom] = [margin + inner.width, margin + inner.height];
    for (const [x, y, toX, toY] of [[-9, -9, width + 9, margin], [-9, bottom, width + 9, height + 9], [-9, -9, margin, height + 9], [right, -9, width + 9, height + 9]]) context.fillRect(x, y, toX - x, toY - y);
  }

  lines(lines: readonly PaperLine[], colour: string): void {
    for (const { from, to, width } of lines) this.stroke([from, to], false, colour, width);
  }

  drawn(lines: readonly DrawnLine[]): void {
    const { context, paper: { margin, inner } } = this;
    context.save();
    context.beginPath();
    context.rect(margin, margin, inner.width, inner.height);
    context.clip();
    for (const { points, isClosed, layer } of lines) this.stroke(points.map((point) => onPaper(this.paper, point)), isClosed, layer === 'SECTION' ? INK : BROWN, WIDTHS[layer]);
    for (const line of lines) this.label(line);
    context.restore();
  }

  texts(): void {
    const { context, paper: { texts, width, margin } } = this;
    context.fillStyle = INK;
    context.font = `${TEXT_HEIGHT}px ${FONT}`;
    for (const { at: [x, y], text, anchor, isTurned = false } of texts) {
      context.save();
      context.translate(x, y);
      if (isTurned) context.rotate(-Math.PI / 2);
      context.textAlign = anchor === 'middle' ? 'center' : anchor;
      context.fillText(text, 0, 0, anchor === 'start' ? width - margin / 2 - x : undefined);
      context.restore();
    }
  }

  private stroke(points: readonly Flat[], isClosed: boolean, colour: string, width: number): void {
    const { context } = this;
    context.beginPath();
    points.forEach(([x, y], i) => { if (i === 0) context.moveTo(x, y); else context.lineTo(x, y); });
    if (isClosed) context.closePath();
    Object.assign(context, { strokeStyle: colour, lineWidth: width, lineJoin: 'round' });
    context.stroke();
  }

  private label(line: DrawnLine): void {
    const { context, paper } = this;
    const middle = line.label === undefined || lengthOfLine(line) * paper.mmPerUnit < LEAST_LABELLED ? null : middleOf(line);
    if (middle === null) return;
    const { at, along: [x, y] } = middle;
    const [left, top] = onPaper(paper, at);
    context.save();
    context.transform(x, -y, y, x, left, top);
    Object.assign(context, { font: `${LABEL_HEIGHT}px ${FONT}`, textAlign: 'center', textBaseline: 'middle', strokeStyle: '#fff', fillStyle: BROWN, lineWidth: 0.6 });
    context.strokeText(line.label!, 0, 0);
    context.fillText(line.label!, 0, 0);
    context.restore();
  }
}

/// The pixels that a line takes, with its label.
type Reach = readonly [left: number, top: number, right: number, bottom: number];

function reachOf({ points }: DrawnLine, paper: Paper, pixels: number): Reach {
  const room = 2 * LEAST_LABELLED;
  let [left, top, right, bottom] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const point of points) {
    const [x, y] = onPaper(paper, point);
    [left, top, right, bottom] = [Math.min(left, x), Math.min(top, y), Math.max(right, x), Math.max(bottom, y)];
  }
  return [pixels * (left - room), pixels * (top - room), pixels * (right + room), pixels * (bottom + room)];
}

function meets([left, top, right, bottom]: Reach, { x, y, width, height }: Part): boolean {
  return right >= x && left <= x + width && bottom >= y && top <= y + height;
}

/// Paints a part of the paper: r, g, b, a, the uppermost row first; colours are not multiplied by a.
function paintPart(paper: Paper, lines: readonly DrawnLine[], pixels: number, { x, y, width, height }: Part): Uint8ClampedArray {
  const context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true })!;
  context.setTransform(pixels, 0, 0, pixels, -x, -y);
  const painter = new Painter(context, paper);
  painter.lines(paper.grid, GREY);
  painter.drawn(lines);
  painter.margins();
  painter.lines(paper.frame, INK);
  painter.lines(paper.bar, INK);
  painter.texts();
  return context.getImageData(0, 0, width, height).data;
}

/// Lays a painting over pixels of the same part, which have their lowest row first and colours multiplied by a.
export function layOver(pixels: Uint8Array, over: ArrayLike<number>, { width, height }: Part): void {
  for (let row = 0; row < height; ++row)
    for (let i = 4 * width * row, from = 4 * width * (height - 1 - row), end = i + 4 * width; i < end; i += 4, from += 4) {
      const alpha = over[from + 3];
      if (alpha === 0) continue;
      for (let k = 0; k < 3; ++k) pixels[i + k] = Math.round((over[from + k] * alpha + pixels[i + k] * (255 - alpha)) / 255);
      pixels[i + 3] = Math.round(alpha + (pixels[i + 3] * (255 - alpha)) / 255);
    }
}

/// `draw`: the model, as a camera sees it whose picture is the paper.
export function paperDrawer(draw: DrawPart, paper: Paper, lines: readonly DrawnLine[], dotsPerInch: number): DrawPart {
  const pixels = pixelsPerMm(dotsPerInch);
  const reaches = lines.map((line) => reachOf(line, paper, pixels));
  return (size, part) => {
    const drawn = draw(size, part);
    const near = lines.filter((_, i) => meets(reaches[i], part));
    layOver(drawn, paintPart(paper, near, pixels, part), part);
    return drawn;
  };
}
