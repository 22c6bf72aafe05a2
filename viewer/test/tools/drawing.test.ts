// SPDX-License-Identifier: MIT
import { Matrix4, Vector3 } from 'three';
import { afterAll, describe, expect, it } from 'vitest';
import { HierarchyView } from '../../src/index.js';
import { heightAt } from '../../src/scene/projection.js';
import { contourGeoJson } from '../../src/tools/contour_geojson.js';
import { contoursOf, INDEX_EVERY, MOST_HEIGHTS, roundInterval } from '../../src/tools/contours.js';
import { Coordinates } from '../../src/tools/coordinates.js';
import { drawingDxf } from '../../src/tools/drawing_dxf.js';
import { DRAWING_SIDES, drawnPlace, extentOf, frameOf, paperAxis, poseFor, stretchedFrame } from '../../src/tools/drawing_side.js';
import { drawingSvg } from '../../src/tools/drawing_svg.js';
import { contourLines, lengthOfLine, middleOf, sectionLines, type DrawingFrame } from '../../src/tools/line_drawing.js';
import { originalContours, originalSection } from '../../src/tools/original_lines.js';
import { layOver, sizeOfPaper } from '../../src/tools/paint_paper.js';
import { coordinateText, onPaper, paperFor, problemOfPaper, scaleText, type PaperRequest } from '../../src/tools/paper.js';
import { lengthOf, sectionOf } from '../../src/tools/section.js';
import { cross, dot, type Vector } from '../../src/tools/vectors.js';
import { cube, drawnTile } from '../support/drawn.js';
import { fetchFrom, hasProgram, Workshop } from '../support/meshhier.js';

const PLAN: DrawingFrame = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const AS_IS = (point: Vector): Vector => point;
/// Upright as the view stands a model whose z is up.
const Z_UP = new Matrix4().set(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1);
const REQUEST: PaperRequest = { scale: 50, metres: 1, sign: 'm', axes: [paperAxis([1, 0, 0]), paperAxis([0, 1, 0])], hasGrid: true, titles: ['a', 'b'] };

interface Contoured {
  readonly coordinates_of?: string;
  readonly features: readonly { readonly properties: object; readonly geometry: { readonly coordinates: readonly (readonly number[])[] } }[];
}

function read(text: string): Contoured {
  return JSON.parse(text) as Contoured;
}

describe('contours', () => {
  const HEIGHTS = { up: [0, 0, 1] as const, shift: 100 };
  const slope = drawnTile([0, 0, 0, 10, 0, 10, 0, 10, 0, 10, 10, 10], [0, 1, 2, 2, 1, 3]);

  it('of a slope are straight lines at multiples of the interval, each fifth an index', () => {
    const contours = contoursOf([slope], HEIGHTS, 1);
    expect(contours.map(({ height }) => height)).toEqual([101, 102, 103, 104, 105, 106, 107, 108, 109, 110]);
    expect(contours.filter(({ isIndex }) => isIndex).map(({ height }) => height)).toEqual([105, 110]);
    for (const { height, lines } of contours) {
      expect(lines).toHaveLength(1);
      for (const [x, , z] of lines[0].points) expect([x, z]).toEqual([expect.closeTo(height - 100, 12), expect.closeTo(height - 100, 12)]);
      expect(lengthOf(lines[0])).toBeCloseTo(10, 12);
    }
  });

  it('are closed around a hill, and none where it is flat', () => {
    const pyramid = drawnTile([-2, -2, 0, 2, -2, 0, 2, 2, 0, -2, 2, 0, 0, 0, 2], [0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4]);
    const contours = contoursOf([pyramid], { up: [0, 0, 1], shift: 0 }, 0.5);
    expect(contours.map(({ height, lines: [line, ...more] }) => [height, line.isClosed, more.length, Number(lengthOf(line).toFixed(9))])).toEqual([[0.5, true, 0, 12], [1, true, 0, 8], [1.5, true, 0, 4]]);
    expect(contoursOf([drawnTile([0, 0, 5, 1, 0, 5, 0, 1, 5], [0, 1, 2])], { up: [0, 0, 1], shift: 0 }, 1)).toEqual([]);
  });

  it('have round heights, and are not too many', () => {
    const tenths = contoursOf([slope], HEIGHTS, 0.1).map(({ height }) => height);
    expect(tenths).toHaveLength(100);
    expect(tenths.every((height) => String(height).length <= 5)).toBe(true);
    expect(() => contoursOf([slope], HEIGHTS, 9 / MOST_HEIGHTS)).toThrow(RangeError);
    expect(() => contoursOf([slope], HEIGHTS, 0)).toThrow(RangeError);
    expect([roundInterval(100), roundInterval(0.07), roundInterval(0)]).toEqual([5, 0.005, 1]);
    expect(INDEX_EVERY).toBe(5);
  });

  it('are GeoJSON that names heights', () => {
    const contours = contoursOf([slope], HEIGHTS, 5);
    const { features, coordinates_of } = read(contourGeoJson(contours, PLAN, ([x, y, z]) => [x, y, z + 100], () => null));
    expect(coordinates_of).toContain('no place');
    expect(features.map(({ properties }) => properties)).toEqual([{ elevation: 105, index: false, closed: false }, { elevation: 110, index: false, closed: false }]);
    expect(features[0].geometry.coordinates).toContainEqual([5, 0, 105]);
    const placed = read(contourGeoJson(contours, PLAN, AS_IS, ([x, y, z]) => ({ longitude: x / 10, latitude: y / 10, height: z })));
    expect([placed.coordinates_of, placed.features[0].geometry.coordinates[0].length]).toEqual([undefined, 3]);
  });
});

describe('a side of a drawing', () => {
  it.each(DRAWING_SIDES)('%s has axes at right angles, which are the input\'s', (side) => {
    for (const matrix of [new Matrix4(), Z_UP]) {
      const [right, up, towards] = frameOf(side, matrix);
      cross(right, up).forEach((value, k) => { expect(value).toBeCloseTo(towards[k], 12); });
      for (const axis of [right, up, towards]) expect(axis.filter((value) => value === 0)).toHaveLength(2);
    }
  });

  it('has the front below in a plan, and heights up in elevations, also where y is up', () => {
    expect(frameOf('plan', Z_UP)).toEqual([[1, 0, 0], [0, 1, 0], [0, 0, 1]]);
    expect(frameOf('front', Z_UP)).toEqual([[1, 0, 0], [0, 0, 1], [0, -1, 0]]);
    expect(frameOf('back', Z_UP)[0]).toEqual([-1, 0, 0]);
    expect(frameOf('left', Z_UP)[0]).toEqual([0, -1, 0]);
    expect(frameOf('plan', new Matrix4())).toEqual([[1, 0, 0], [0, 0, -1], [0, 1, 0]]);
    expect(paperAxis([0, 0, -1])).toEqual({ name: 'z', sign: -1, stretch: 1 });
  });

  it('is looked at so that its middle is in the middle, however high heights are stretched', () => {
    const stretched = new Matrix4().set(1, 0, 0, 0, 0, 0, 3, 0, 0, -1, 0, 0, 0, 0, 0, 1);
    const origin: Vector = [100, 200, 50];
    for (const side of DRAWING_SIDES) {
      const frame = stretchedFrame(side, frameOf(side, stretched), 3);
      const input: Vector = [104, 203, 52];
      const middle = [dot(frame[0], input), dot(frame[1], input)] as const;
      const pose = poseFor(side, middle, 10, frame, origin, Math.PI / 4);
      const world = new Vector3(4, 3, 2).applyMatrix4(stretched);
      const back = pose.position.clone().sub(pose.target).normalize();
      expect(world.sub(pose.target).cross(back).length()).toBeLessThan(1e-9);
      expect(heightAt(pose.distance, Math.PI / 4)).toBeCloseTo(10, 9);
      const place = drawnPlace(side, pose.target, frame, origin);
      expect([place[0], place[1]]).toEqual([expect.closeTo(middle[0], 9), expect.closeTo(middle[1], 9)]);
    }
  });
});

describe('a paper', () => {
  const extent = extentOf({ min: [352_010, 20, 0], max: [352_020, 28, 3] }, PLAN);

  it('has its scale, and places of the drawing where they are', () => {
    const paper = paperFor(extent, REQUEST);
    expect([paper.mmPerUnit, paper.inner.width, paper.inner.height]).toEqual([20, 200, 160]);
    const [a, b] = [onPaper(paper, [352_010, 28]), onPaper(paper, [352_015, 24])];
    expect([a[0], a[1], b[0] - a[0], b[1] - a[1]]).toEqual([paper.margin, paper.margin, 100, 80]);
    const { width } = sizeOfPaper(paper, 254);
    expect(width).toBe(Math.ceil(10 * paper.width));
  });

  it('has a grid of round coordinates', () => {
    const paper = paperFor(extent, REQUEST);
    expect(paper.grid).toHaveLength(6 + 5); // each 2 m
    expect(paper.texts.map(({ text }) => text)).toEqual(expect.arrayContaining(['352010', '352012', '20', '28', '0', '2 m', 'x', 'y', 'a', 'b']));
    expect(paperFor(extent, { ...REQUEST, hasGrid: false }).grid).toEqual([]);
    const mirrored = paperFor({ left: -20, right: -10, bottom: 0, top: 3 }, { ...REQUEST, axes: [paperAxis([-1, 0, 0]), paperAxis([0, 0, 3], 3)] });
    expect(mirrored.texts.map(({ text }) => text)).toEqual(expect.arrayContaining(['10', '20', '−x', 'z']));
    expect(mirrored.texts.filter(({ isTurned }) => isTurned).map(({ text }) => text)).toEqual(['0']); // 1 is at 3, 2 is beyond
  });

  it('has room for its titles, and is refused where nothing would be seen', () => {
    expect(paperFor({ left: 0, right: 0.1, bottom: 0, top: 0.1 }, REQUEST).inner).toEqual({ width: expect.closeTo(60, 9) as number, height: expect.closeTo(2, 9) as number });
    expect([problemOfPaper({ width: 0.2, height: 0.9 })?.what, problemOfPaper({ width: 5, height: 1e6 })?.what, problemOfPaper({ width: 5, height: 5 })]).toEqual(['small', 'large', null]);
    expect([scaleText(50), scaleText(0.5), scaleText(1), coordinateText(-0.00001, 0.5), coordinateText(1e6, 1000)]).toEqual(['1:50', '2:1', '1:1', '0.0', '1000000']);
  });
});

describe('lines of a drawing', () => {
  const section = sectionOf([cube([1, 2, 3])], { normal: [0, 0, 1], constant: -4 });
  const lines = sectionLines(section, PLAN, AS_IS, 4);
  const paper = paperFor({ left: 0, right: 4, bottom: 0, top: 5 }, REQUEST);

  it('are in the drawing\'s coordinates, and know their middle', () => {
    expect(lines).toHaveLength(1);
    expect([lines[0].isClosed, lines[0].height, lengthOfLine(lines[0])]).toEqual([true, 4, 8]);
    const middle = middleOf({ points: [[0, 0], [-4, 0], [-4, -2]], isClosed: false })!;
    expect([middle.at[0], middle.at[1] + 0, middle.along[0], middle.along[1] + 0]).toEqual([-3, 0, 1, 0]); // can be read
    expect(middleOf({ points: [[1, 1]], isClosed: false })).toBeNull();
  });

  it('are SVG in millimetres of the paper', () => {
    const svg = drawingSvg(lines, paper, 'a <b>', 'cut');
    expect(svg).toContain(`width="${paper.width}mm"`);
    const path = /<path data-height="4" d="M([^"]*)Z"/.exec(svg)![1];
    const places = path.split('L').map((place) => place.split(' ').map(Number));
    expect(Math.min(...places.map(([x]) => x))).toBeCloseTo(paper.margin + 20, 4);
    expect(Math.max(...places.map(([, y]) => y))).toBeCloseTo(paper.margin + 60, 4);
    expect(svg).toContain('<title>a &#60;b&#62;</title>');
    expect(svg).toContain('id="SCALE"');
  });

  it('are DXF in true units, on layers, with the unit told', () => {
    const slope = drawnTile([0, 0, 0, 40, 0, 10, 0, 40, 0, 40, 40, 10], [0, 1, 2, 2, 1, 3]);
    const contours = contourLines(contoursOf([slope], { up: [0, 0, 1], shift: 0 }, 1), 1, PLAN, AS_IS);
    const groups = drawingDxf([...lines, ...contours], paperFor({ left: 0, right: 40, bottom: 0, top: 40 }, { ...REQUEST, scale: 200, titles: ['Grüße'] }), 'mm').split('\n');
    const pairs = Array.from({ length: Math.floor(groups.length / 2) }, (_, i) => [groups[2 * i].trim(), groups[2 * i + 1]]);
    expect(groups.length % 2).toBe(1); // a line break at the end
    expect(pairs[pairs.findIndex(([, value]) => value === '$INSUNITS') + 1]).toEqual(['70', '4']);
    const layers = new Set(pairs.filter(([code]) => code === '8').map(([, value]) => value));
    expect([...layers].sort()).toEqual(['0', 'CONTOUR', 'CONTOUR_INDEX', 'CONTOUR_LABEL', 'GRID', 'SCALE', 'SECTION']);
    expect(pairs).toContainEqual(['1', 'Gr\\U+00FC\\U+00DFe']);
    const handles = pairs.filter(([code]) => code === '5').map(([, value]) => value);
    expect(new Set(handles).size).toBe(handles.length);
  });

  it('are laid over a picture, as much as they cover', () => {
    const pixels = Uint8Array.of(10, 20, 30, 255, 0, 0, 0, 0); // the lower row first
    layOver(pixels, [200, 100, 0, 128, 255, 255, 255, 255], { x: 0, y: 0, width: 1, height: 2 });
    expect([...pixels]).toEqual([255, 255, 255, 255, 100, 50, 0, 128]);
  });
});

describe.skipIf(!hasProgram)('lines of the original', () => {
  const workshop = new Workshop();
  afterAll(() => { workshop.remove(); });

  it('are those of what is shown where that is the original, and closed over its partitions', async () => {
    const directory = workshop.build('torus', ['surface', '--triangles', '12000', '--shape', 'torus'], { partition: { vertices: 200 } });
    const view = new HierarchyView('', { fetch: fetchFrom(directory) });
    await view.opened;
    await new Promise((resolve) => setTimeout(resolve, 200));
    const { signal } = new AbortController();
    const plane = { normal: [0, 0, 1], constant: -0.0123 } as const;
    const lines = await originalSection(view.source!, plane, { signal });
    expect(lines.length).toBeGreaterThan(0);
    expect(lines.every(({ isClosed }) => isClosed)).toBe(true);
    const contours = await originalContours(view.source!, { up: [0, 0, 1], shift: new Coordinates(view.manifest!).toInput([0, 0, 0])[2] }, 0.05, { signal });
    expect(contours.length).toBeGreaterThan(5);
    expect(contours.every((contour) => contour.lines.every(({ isClosed }) => isClosed))).toBe(true);
    const stopped = new AbortController();
    stopped.abort(new Error('enough'));
    await expect(originalSection(view.source!, plane, { signal: stopped.signal })).rejects.toThrow('enough');
    view.dispose();
  });
});
