// SPDX-License-Identifier: MIT
import { Matrix4, PerspectiveCamera, Vector3 } from 'three';
import { afterAll, describe, expect, it } from 'vitest';
import { HierarchyView } from '../../src/index.js';
import { boxPlanes, flipped, localNormal, planeThrough, sideOf, worldPlane, type CutPlane } from '../../src/tools/planes.js';
import { lengthOf, sectionOf, type Polyline } from '../../src/tools/section.js';
import { drawingAxes, sectionSvg } from '../../src/tools/section_svg.js';
import { unit, type Vector } from '../../src/tools/vectors.js';
import { cube, drawnTile } from '../support/drawn.js';
import { fetchFrom, hasProgram, Workshop } from '../support/meshhier.js';

const [UP_Y, UP_Z]: Vector[] = [[0, 1, 0], [0, 0, 1]];
const at = (height: number): CutPlane => ({ normal: [0, 0, 1], constant: -height });
const total = (lines: readonly Polyline[]): number => lines.reduce((sum, line) => sum + lengthOf(line), 0);

describe('planes', () => {
  it('keep what lies before them, and their own points', () => {
    const plane = planeThrough([1, 2, 3], unit([1, 1, 0]));
    expect(sideOf(plane, [1, 2, 9])).toBeCloseTo(0, 12);
    expect([sideOf(plane, [3, 3, 0]) > 0, sideOf(flipped(plane), [3, 3, 0]) < 0]).toEqual([true, true]);
    const box = boxPlanes([0, 0, 0], [1, 2, 3]);
    const points: Vector[] = [[0, 0, 0], [1, 2, 3], [1.1, 1, 1], [0.5, -0.1, 1]];
    expect(points.map((point) => box.every((each) => sideOf(each, point) >= 0))).toEqual([true, true, false, false]);
  });

  it('keep the same in the world', () => {
    const view = new Vector3(1, 0, 0);
    const { matrixWorld } = new PerspectiveCamera();
    matrixWorld.makeRotationZ(Math.PI / 2).setPosition(5, 0, 0);
    expect(worldPlane({ normal: [1, 0, 0], constant: -1 }, matrixWorld).distanceToPoint(view.set(5, 3, 0))).toBeCloseTo(2, 12);
  });

  it('across a direction of the world are so, also where heights are stretched', () => {
    const matrix = new Matrix4().set(1, 0, 0, 0, 0, 0, 7, 0, 0, -1, 0, 0, 0, 0, 0, 1);
    for (const direction of [[1, 0, 0], [0, -1, 0], unit([1, 2, 3])] as Vector[]) {
      const plane = worldPlane(planeThrough([1, 2, 3], localNormal(direction, matrix)), matrix);
      plane.normal.toArray().forEach((value, axis) => { expect(value).toBeCloseTo(direction[axis], 12); });
      expect(plane.distanceToPoint(new Vector3(1, 2, 3).applyMatrix4(matrix))).toBeCloseTo(0, 12);
    }
  });
});

describe('a section', () => {
  it('of a cube is a square, one closed line, whose points lie on the plane', () => {
    const lines = sectionOf([cube()], at(0.5));
    expect(lines).toHaveLength(1);
    expect(lines[0].isClosed).toBe(true);
    expect(lines[0].points).toHaveLength(8); // each side's diagonal is cut, too
    expect(lines[0].points.every(([, , z]) => z === 0.5)).toBe(true);
    expect(lengthOf(lines[0])).toBe(8);
  });

  it('through vertices is whole, and there once', () => {
    expect(total(sectionOf([cube()], at(2)))).toBe(8);
    expect(total(sectionOf([cube(), cube([0, 0, 2])], at(2)))).toBe(8);
    expect(sectionOf([cube()], at(0))).toEqual([]);
    const diagonal = sectionOf([cube()], planeThrough([0, 0, 0], unit([1, -1, 0])));
    expect(diagonal.map(({ isClosed }) => isClosed)).toEqual([true]);
    expect(lengthOf(diagonal[0])).toBeCloseTo(4 + 4 * Math.SQRT2, 12);
  });

  it('of two bodies is two lines, and of nothing none', () => {
    expect(sectionOf([cube(), cube([5, 0, 0])], at(1)).map(lengthOf)).toEqual([8, 8]);
    expect(sectionOf([cube()], at(7))).toEqual([]);
    expect(sectionOf([], at(7))).toEqual([]);
  });

  it('counts triangles that a mesh repeats once, and knows a zero by either sign', () => {
    const once = drawnTile([0, 0, -1, 0, 0, 1, 2, 0, 1], [0, 1, 2]);
    const again = drawnTile([-0, 0, -1, 0, -0, 1, 2, 0, 1], [0, 1, 2]);
    expect(sectionOf([once, again], at(0))).toMatchObject([{ isClosed: false, points: [[0, 0, 0], [1, 0, 0]] }]);
  });

  it('of an open surface has ends where it has', () => {
    const strip = drawnTile([0, 0, 0, 0, 0, 2, 1, 0, 0, 1, 0, 2, 2, 0, 0, 2, 0, 2], [0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 3, 5]);
    const [line, ...more] = sectionOf([strip], at(0.5));
    expect(more).toEqual([]);
    expect(line.isClosed).toBe(false);
    expect([line.points[0], line.points[line.points.length - 1]].map(([x]) => x).sort()).toEqual([0, 2]);
    expect(lengthOf(line)).toBe(2);
  });
});

describe.skipIf(!hasProgram)('a section of a hierarchy', () => {
  const workshop = new Workshop();
  afterAll(() => { workshop.remove(); });

  it.each([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 2, 3]] as Vector[])('is closed lines over tiles of several levels, across %d %d %d', async (...normal) => {
    const directory = workshop.build('torus', ['surface', '--triangles', '12000', '--shape', 'torus'], { partition: { vertices: 200 } });
    const view = new HierarchyView('', { fetch: fetchFrom(directory), settings: { threshold: 0.125, restDetail: 1 } });
    const camera = new PerspectiveCamera(45, 4 / 3, 1e-3, 1e9);
    camera.position.set(0.9, 0.3, 1.2);
    camera.lookAt(0.7, 0, 0);
    await view.opened;
    view.showsInside = true;
    for (let now = 0; !view.stats().settled; now += 100) {
      view.update(camera, { width: 400, height: 300 }, now);
      await new Promise((resolve) => setImmediate(resolve));
    }
    expect(new Set(view.surface.map(({ node }) => node.level)).size).toBeGreaterThan(1);
    const plane = planeThrough([0.01, 0.02, 0.03], unit(normal));
    const lines = sectionOf(view.surface, plane);
    expect(lines.length).toBeGreaterThan(0);
    expect(lines.every(({ isClosed }) => isClosed)).toBe(true);
    for (const { points } of lines) for (const point of points) expect(Math.abs(sideOf(plane, point))).toBeLessThan(1e-12);
    view.dispose();
  });
});

describe.skipIf(!hasProgram)('a view that shows the inside', () => {
  const workshop = new Workshop();
  afterAll(() => { workshop.remove(); });

  it('refines what looks away as well', async () => {
    const directory = workshop.build('sphere', ['surface', '--triangles', '24000', '--height', '0.05'], { partition: { vertices: 100 } });
    const view = new HierarchyView('', { fetch: fetchFrom(directory), settings: { threshold: 0.05, restDetail: 1 } });
    const camera = new PerspectiveCamera(45, 4 / 3, 1e-3, 1e9);
    camera.position.set(0, 0, 5);
    camera.lookAt(0, 0, 0);
    await view.opened;
    expect(view.closed).toBe(true);
    let now = 0;
    const tilesOf = async (): Promise<number> => {
      do {
        view.update(camera, { width: 800, height: 600 }, (now += 100));
        await new Promise((resolve) => setImmediate(resolve));
      } while (!view.stats().settled);
      return view.stats().tiles;
    };
    const outside = await tilesOf();
    view.showsInside = true;
    expect(await tilesOf()).toBeGreaterThan(outside);
    view.showsInside = false;
    expect(await tilesOf()).toBe(outside);
    view.dispose();
  });
});

describe('the drawing of a section', () => {
  const square: Polyline = { isClosed: true, points: [[10, 20, 5], [12, 20, 5], [12, 23, 5], [10, 23, 5]] };

  it('across an axis has the two others, up where there is one', () => {
    expect(drawingAxes([0, 0, 1], UP_Z)).toEqual([[1, 0, 0], [0, 1, 0]]);
    expect(drawingAxes([-1, 0, 0], UP_Z)).toEqual([[0, 1, 0], [0, 0, 1]]);
    expect(drawingAxes([1, 0, 0], UP_Y)).toEqual([[0, 0, 1], [0, 1, 0]]);
    expect(drawingAxes([0, 1, 0], UP_Y)).toEqual([[1, 0, 0], [0, 0, 1]]);
    const [right, up] = drawingAxes(unit([1, 1, 0]), UP_Z);
    expect(drawingAxes([-1, 0, 0], [0, 0, -1])).toEqual([[0, 1, 0], [0, 0, 1]]); // their own numbers
    expect([Math.abs(right[2]), up[2]]).toEqual([0, expect.closeTo(1, 12)]);
  });

  it('is in true size, upright, and tells where it was', () => {
    const svg = sectionSvg([square], { axes: drawingAxes([0, 0, 1], UP_Z), unit: 'm', title: 'a <b> & "c"' });
    expect(svg).toContain('width="2000mm" height="3000mm" viewBox="0 0 2 3"');
    expect(svg).toContain('d="M0 3L2 3L2 0L0 0Z"');
    expect(svg).toContain('To the right 1 0 0 + 10, up 0 1 0 + 20');
    expect(svg).toContain('<title>a &#60;b&#62; &#38; &#34;c&#34;</title>');
  });

  it('of an unknown unit has its numbers, and of nothing no size', () => {
    const drawing = { axes: drawingAxes([0, 0, 1], UP_Z), unit: 'unit', title: '' } as const;
    expect(sectionSvg([{ ...square, isClosed: false }], drawing)).toMatch(/width="2" height="3" [^]*0L0 0"/);
    expect(sectionSvg([], drawing)).toContain('viewBox="0 0 0 0"');
  });
});
