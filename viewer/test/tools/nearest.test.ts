// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { PointProbe } from '../../src/tools/nearest.js';
import { distanceOf, type Vector } from '../../src/tools/vectors.js';

const CORNERS: readonly Vector[] = [[0, 0, 0], [4, 0, 1], [1, 3, -1]];
const POSITIONS = CORNERS.flat();

/// Of points all over the triangle.
function byTrying(point: Vector): number {
  let least = Infinity;
  const steps = 400;
  for (let i = 0; i <= steps; ++i)
    for (let j = 0; i + j <= steps; ++j) {
      const weights = [i / steps, j / steps, 1 - (i + j) / steps];
      const at = [0, 1, 2].map((axis) => CORNERS.reduce((sum, corner, k) => sum + weights[k] * corner[axis], 0)) as unknown as Vector;
      least = Math.min(least, distanceOf(point, at));
    }
  return least;
}

describe('the place of a triangle nearest to a point', () => {
  it.each<Vector>([[1, 1, 5], [-2, -1, 0], [6, -1, 2], [1, 6, -2], [2, -3, 0], [4, 3, 0], [-1, 2, 0], [1.5, 1, 0]])('is found from %j', (...point) => {
    const probe = new PointProbe(point);
    const distance = probe.hits(POSITIONS, 0, 1, 2);
    expect(distance).toBeLessThanOrEqual(byTrying(point) + 1e-12);
    expect(distance).toBeGreaterThan(byTrying(point) - 0.02);
    expect(probe.weights.reduce((sum, each) => sum + each)).toBeCloseTo(1, 12);
  });

  it('is none of a triangle that is a point', () => {
    expect(new PointProbe([1, 0, 0]).hits([0, 0, 0, 0, 0, 0, 0, 0, 0], 0, 1, 2)).toBe(1);
  });

  it('is no nearer than boxes and spheres around it', () => {
    const probe = new PointProbe([3, 0, 0]);
    expect(probe.enters([0, 0, 0, 1, 1, 1])).toBe(2);
    expect(probe.enters([0, -1, -1, 5, 1, 1])).toBe(0);
    expect(probe.entersSphere([0, 0, 0], 2)).toBe(1);
  });
});
