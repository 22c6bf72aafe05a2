// SPDX-License-Identifier: MIT
// A drawing as SVG at its scale: one unit of the file is a millimetre of the paper.
import { lengthOfLine, middleOf, type DrawnLine, type LineLayer } from './line_drawing.js';
import { CONTOUR_WIDTH, INDEX_WIDTH, onPaper, SECTION_WIDTH, TEXT_HEIGHT, type Flat, type Paper, type PaperLine, type PaperText } from './paper.js';

const STYLES: Readonly<Record<LineLayer, { readonly colour: string; readonly width: number }>> = {
  CONTOUR: { colour: '#84532b', width: CONTOUR_WIDTH },
  CONTOUR_INDEX: { colour: '#84532b', width: INDEX_WIDTH },
  SECTION: { colour: '#000', width: SECTION_WIDTH },
};
export const LABEL_HEIGHT = 2;
/// A shorter line has no label, in millimetres.
export const LEAST_LABELLED = 20;

export function escaped(text: string): string {
  return text.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);
}

/// To a tenth of a micrometre.
function mm(value: number): string {
  return String(Number(value.toFixed(4)) + 0);
}

function place([x, y]: Flat): string {
  return `${mm(x)} ${mm(y)}`;
}

function linesOf(id: string, colour: string, lines: readonly PaperLine[]): string {
  const paths = lines.map(({ from, to, width }) => `<path d="M${place(from)}L${place(to)}" stroke-width="${mm(width)}"/>`);
  return `<g id="${id}" stroke="${colour}" fill="none">\n${paths.join('\n')}\n</g>`;
}

function layerOf(layer: LineLayer, lines: readonly DrawnLine[], paper: Paper): string {
  const paths = lines.filter((line) => line.layer === layer).map(({ points, isClosed, height }) => {
    const places = points.map((point) => place(onPaper(paper, point)));
    return `<path data-height="${height}" d="M${places.join('L')}${isClosed ? 'Z' : ''}"/>`;
  });
  const { colour, width } = STYLES[layer];
  return paths.length === 0 ? '' : `<g id="${layer}" fill="none" stroke="${colour}" stroke-width="${width}" stroke-linejoin="round">\n${paths.join('\n')}\n</g>\n`;
}

function labelsOf(lines: readonly DrawnLine[], paper: Paper): string {
  const texts = lines.flatMap((line) => {
    const middle = line.label === undefined || lengthOfLine(line) * paper.mmPerUnit < LEAST_LABELLED ? null : middleOf(line);
    if (middle === null) return [];
    const { at, along: [x, y] } = middle;
    return [`<text transform="matrix(${mm(x)} ${mm(-y)} ${mm(y)} ${mm(x)} ${place(onPaper(paper, at))})" dy="${0.35 * LABEL_HEIGHT}">${escaped(line.label!)}</text>`];
  });
  return texts.length === 0 ? '' : `<g font-family="sans-serif" font-size="${LABEL_HEIGHT}" text-anchor="middle" fill="#84532b" stroke="#fff" stroke-width="0.6" paint-order="stroke">\n${texts.join('\n')}\n</g>\n`;
}

function textOf({ at, text, anchor, isTurned = false }: PaperText): string {
  const where = isTurned ? `transform="translate(${place(at)}) rotate(-90)"` : `x="${mm(at[0])}" y="${mm(at[1])}"`;
  return `<text ${where} text-anchor="${anchor}">${escaped(text)}</text>`;
}

/// `description`: tells what the lines are, and how the drawing's coordinates come of the input's.
export function drawingSvg(lines: readonly DrawnLine[], paper: Paper, title: string, description: string): string {
  const { width, height, extent, margin, mmPerUnit } = paper;
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${mm(width)}mm" height="${mm(height)}mm" viewBox="0 0 ${mm(width)} ${mm(height)}">
<title>${escaped(title)}</title>
<desc>${escaped(description)} A unit is ${mmPerUnit} mm; the place ${margin} ${margin} of the paper is ${extent.left} ${extent.top}.</desc>
<rect width="100%" height="100%" fill="#fff"/>
${linesOf('GRID', '#999', paper.grid)}
${(Object.keys(STYLES) as LineLayer[]).map((layer) => layerOf(layer, lines, paper)).join('')}${labelsOf(lines, paper)}${linesOf('FRAME', '#000', paper.frame)}
${linesOf('SCALE', '#000', paper.bar)}
<g font-family="sans-serif" font-size="${TEXT_HEIGHT}">
${paper.texts.map(textOf).join('\n')}
</g>
</svg>
`;
}
