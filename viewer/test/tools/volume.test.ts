// SPDX-License-Identifier: MIT
import { PerspectiveCamera } from 'three';
import { afterAll, describe, expect, it } from 'vitest';
import type { Node } from '../../src/hierarchy/tree.js';
import { HierarchyView } from '../../src/index.js';
import { boxPlanes, flipped, planeThrough, type CutPlane } from '../../src/tools/planes.js';
import { shownBound } from '../../src/tools/shown_bound.js';
import { LengthScale } from '../../src/tools/units.js';
import { unit, type Vector } from '../../src/tools/vectors.js';
import { originalVolume } from '../../src/tools/original_volume.js';
import { volumeOf, type Volume } from '../../src/tools/volume.js';
import { cube, drawnTile } from '../support/drawn.js';
import { fetchFrom, hasProgram, Workshop } from '../support/meshhier.js';
import { random as numbersFrom } from '../support/random.js';

const exact = (): number => 0;
const DOWN: CutPlane = { normal: [0, 0, 1], constant: 100 };

/// A closed fan around an axis: the volume of a double pyramid over any polygon.
function doublePyramid(around: number, radius: number, height: number): ReturnType<typeof drawnTile> {
  const rim = Array.from({ length: around }, (_, i) => [radius * Math.cos((2 * Math.PI * i) / around), radius * Math.sin((2 * Math.PI * i) / around), 0]);
  const corners = rim.flatMap((_, i) => [around, i, (i + 1) % around, around + 1, (i + 1) % around, i]);
  return drawnTile([...rim.flat(), 0, 0, height, 0, 0, -height], corners);
}

describe('the volume', () => {
  it('of a cube is that of its sides, wherever the plane below it lies', () => {
    for (const normal of [[0, 0, 1], [1, 0, 0], unit([1, 2, -3])] as Vector[]) {
      const below = { normal, constant: 50 };
      expect(volumeOf([cube([1, 2, 3])], [below], exact)).toEqual({ volume: expect.closeTo(8, 9) as number, bound: 0 });
    }
  });

  it('of what a plane keeps and of what it cuts away are all of it', () => {
    const random = numbersFrom(7);
    for (let i = 0; i < 200; ++i) {
      const pick = (): number => 2 * random() - 1;
      const plane = planeThrough([pick(), pick(), pick()], unit([pick(), pick(), pick()]));
      const solid = doublePyramid(3 + Math.floor(9 * random()), 1 + random(), 1 + random());
      const [kept, away, all] = [[plane], [flipped(plane)], [DOWN]].map((planes) => volumeOf([solid], planes, exact).volume);
      expect(kept + away).toBeCloseTo(all, 9);
      expect(kept).toBeGreaterThanOrEqual(-1e-12);
    }
  });

  it('within a box is that of both', () => {
    const inside = (min: Vector, max: Vector): number => volumeOf([cube()], boxPlanes(min, max), exact).volume; // the cube is from 0 to 2
    expect(inside([-1, -1, -1], [3, 3, 3])).toBeCloseTo(8, 12);
    expect(inside([0.5, 0.5, 0.5], [1.5, 1, 1.75])).toBeCloseTo(1 * 0.5 * 1.25, 12);
    expect(inside([1, -1, 1.5], [5, 0.25, 9])).toBeCloseTo(1 * 0.25 * 0.5, 12);
    expect(inside([3, 3, 3], [4, 4, 4])).toBeCloseTo(0, 12);
    expect(inside([-4, 0.5, 0.5], [-3, 1, 1])).toBeCloseTo(0, 12);
  });

  it('within boxes that fill space are all of it', () => {
    const random = numbersFrom(11);
    const solid = doublePyramid(7, 1.5, 1.2);
    const all = volumeOf([solid], [DOWN], exact).volume;
    for (let i = 0; i < 50; ++i) {
      const [x, y, z] = [random(), random(), random()].map((value) => 2 * value - 1);
      let sum = 0;
      for (let octant = 0; octant < 8; ++octant) {
        const side = (bit: number, at: number): [number, number] => ((octant & bit) === 0 ? [-3, at] : [at, 3]);
        const [a, b, c] = [side(1, x), side(2, y), side(4, z)];
        sum += volumeOf([solid], boxPlanes([a[0], b[0], c[0]], [a[1], b[1], c[1]]), exact).volume;
      }
      expect(sum).toBeCloseTo(all, 9);
    }
  });

  it('between a terrain and a level plane is what lies above it, or below', () => {
    const slope = drawnTile([0, 0, -1, 2, 0, 1, 2, 2, 1, 0, 2, -1], [0, 1, 2, 0, 2, 3]); // z = x - 1
    const level: CutPlane = { normal: [0, 0, 1], constant: 0 };
    expect(volumeOf([slope], [level], exact).volume).toBeCloseTo(1, 12);
    expect(volumeOf([slope], [flipped(level)], exact).volume).toBeCloseTo(-1, 12); // seen from the plane its back
  });

  it('is never farther off than it says, where the surface moves', () => {
    const random = numbersFrom(5);
    for (let i = 0; i < 500; ++i) {
      const solid = doublePyramid(3 + Math.floor(9 * random()), 0.2 + random(), 0.2 + random());
      const reach = 0.5 * random() ** 3;
      const moved = Array.from(solid.tile.positions);
      for (let v = 0; v < moved.length; v += 3) {
        const by = unit([random() - 0.5, random() - 0.5, random() - 0.5]).map((part) => part * reach);
        by.forEach((part, axis) => { moved[v + axis] += part; });
      }
      const plane = planeThrough([0, 0, 2 * random() - 1], unit([random() - 0.5, random() - 0.5, random() - 0.5]));
      const { volume, bound } = volumeOf([solid], [plane], () => reach);
      const other = volumeOf([drawnTile(moved, Array.from(solid.tile.indices))], [plane], exact).volume;
      expect(Math.abs(other - volume)).toBeLessThanOrEqual(bound + 1e-6);
    }
  });

  it('of what is far on the other side has no bound', () => {
    expect(volumeOf([cube()], [{ normal: [0, 0, 1], constant: -5 }], () => 0.1)).toEqual({ volume: 0, bound: 0 });
    expect(volumeOf([cube()], [DOWN], () => Infinity).bound).toBe(Infinity);
  });

  it('is told in cubes of the unit', () => {
    expect(new LengthScale('mm', 'cm').formatVolumeWithin(12_345.678, 10)).toBe('12.346 ± 0.010 cm³');
    expect(new LengthScale('unit', 'unit').formatVolume(8)).toBe('8 units³');
  });
});

describe.skipIf(!hasProgram)('the volume of a hierarchy', () => {
  const workshop = new Workshop();
  afterAll(() => { workshop.remove(); });

  async function measured(threshold: number, width = 800): Promise<{ volume: number; bound: number; tiles: number; original: Volume }> {
    const directory = workshop.build('torus', ['surface', '--triangles', '24000', '--shape', 'torus', '--height', '0'], { partition: { vertices: 500 } });
    const view = new HierarchyView('', { fetch: fetchFrom(directory), settings: { threshold, restDetail: 1 } });
    const camera = new PerspectiveCamera(45, 4 / 3, 1e-3, 1e9);
    camera.position.set(0, 0, 5);
    camera.lookAt(0, 0, 0);
    await view.opened;
    view.showsInside = true;
    for (let now = 0; !view.stats().settled; now += 100) {
      view.update(camera, { width, height: (3 * width) / 4 }, now);
      await new Promise((resolve) => setImmediate(resolve));
    }
    const { surface, source } = view;
    const boundOf = (node: Node): number => shownBound(node, surface, (other) => source!.index.record(other)!.bound);
    const planes = [planeThrough([0, 0, 0], unit([1, 2, 3]))];
    const done: number[] = [];
    const original = await originalVolume(source!, planes, { signal: new AbortController().signal, progress: (count) => { done.push(count); } });
    expect(done.length).toBeGreaterThan(10);
    const result = { ...volumeOf(surface, planes, boundOf), tiles: surface.length, original };
    view.dispose();
    return result;
  }

  it('is that of the mesh, as near as it says, the nearer the finer it is shown', async () => {
    const [coarse, middle, fine] = [await measured(1000), await measured(0.5), await measured(0.01, 100_000)];
    expect(coarse.tiles).toBe(1);
    expect(middle.tiles).toBeGreaterThan(1);
    expect(fine.bound).toBe(0);
    for (const { volume, bound } of [coarse, middle]) expect(Math.abs(volume - fine.volume)).toBeLessThanOrEqual(bound);
    expect(middle.bound).toBeLessThan(coarse.bound);
    for (const { original } of [coarse, middle, fine]) expect(original).toEqual({ volume: expect.closeTo(fine.volume, 9) as number, bound: 0 });
    expect(coarse.original.volume).toBe(fine.original.volume);
  });
});
