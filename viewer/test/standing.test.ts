// SPDX-License-Identifier: MIT
import { Group, Matrix4, PerspectiveCamera, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { distance, looksAway, pixelsOf, squarePixels } from '../src/cut/viewpoint.js';
import { viewpointOf } from '../src/scene/motion.js';
import { changedStanding, DEFAULT_STANDING, uprightRows, UPS, upwards } from '../src/scene/standing.js';

function matrixOf(rows: readonly (readonly number[])[]): Matrix4 {
  const [[a, b, c], [d, e, f], [g, h, i]] = rows;
  return new Matrix4().set(a, b, c, 0, d, e, f, 0, g, h, i, 0, 0, 0, 0, 1);
}

describe('a standing', () => {
  it.each(UPS)('turns what is up in it (%s) to y, and mirrors nothing', (up) => {
    for (const zUp of [false, true]) {
      const matrix = matrixOf(uprightRows({ up, stretch: 1 }, zUp));
      expect(new Vector3(...upwards(up, zUp)).applyMatrix4(matrix).toArray()).toEqual([0, 1, 0]);
      expect(matrix.determinant()).toBe(1);
    }
  });

  it('is as the file says if nothing is said', () => {
    expect(upwards('file', true)).toEqual([0, 0, 1]);
    expect(upwards('file', false)).toEqual([0, 1, 0]);
  });

  it('stretches heights alone', () => {
    const matrix = matrixOf(uprightRows({ up: 'z', stretch: 7 }, false));
    expect(new Vector3(1, 2, 3).applyMatrix4(matrix).toArray()).toEqual([1, 21, -2]);
  });

  it('refuses what makes no sense', () => {
    expect(changedStanding({ stretch: 3 }, DEFAULT_STANDING)).toEqual({ up: 'file', stretch: 3 });
    for (const stretch of [0, 0.5, 101, NaN]) expect(() => changedStanding({ stretch }, DEFAULT_STANDING)).toThrow(RangeError);
    expect(() => changedStanding({ up: 'w' as 'x' }, DEFAULT_STANDING)).toThrow(RangeError);
  });
});

describe('a stretched view', () => {
  const camera = new PerspectiveCamera(90, 1, 0.1, 100);
  camera.position.set(0, 0, 10);
  camera.updateMatrixWorld();
  const group = new Group();
  group.scale.set(2, 10, 2);
  group.updateMatrixWorld();
  const view = viewpointOf(camera, group, { width: 100, height: 100 });

  it('measures as it is seen', () => {
    expect(view.stretch).toEqual([1, 5, 1]);
    expect(distance(view, { min: [0, 3, 5], max: [0, 3, 5] })).toBeCloseTo(15, 9); // 3 up counts as 15
    expect(pixelsOf(view, { min: [0, 0, 0], max: [0, 0, 0] }, 0.1)).toBeCloseTo((5 * 0.1 * 50) / 5, 9);
  });

  it('sees squares as they lie', () => {
    const flat = { min: [-1, 0, -1], max: [1, 0, 1] } as const;
    expect(squarePixels(view, flat, 4)).toBeCloseTo(50 / distance(view, flat), 9);
    const wall = { min: [0, -1, -1], max: [0, 1, 1] } as const;
    expect(squarePixels(view, wall, 20)).toBeCloseTo(50 / distance(view, wall), 9);
  });

  it('hides nothing', () => {
    const behind = { axis: [0, 0, -1] as const, cosine: 1 };
    const box = { min: [0, 0, 0], max: [0.1, 0.1, 0.1] } as const;
    expect(looksAway(view, box, behind, 0)).toBe(false);
    expect(looksAway({ ...view, stretch: [1, 1, 1] }, box, behind, 0)).toBe(true);
  });
});
