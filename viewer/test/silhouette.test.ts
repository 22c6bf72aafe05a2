// SPDX-License-Identifier: MIT
import { expect, it } from 'vitest';
import { silhouetteOf } from '../src/scene/silhouette.js';

/// A sphere of points, one far away that no triangle has.
const RINGS = 60;
const sphere = Array.from({ length: RINGS * RINGS }, (_, i) => {
  const [z, turn] = [-1 + (2 * (i + 0.5)) / (RINGS * RINGS), 2.4 * i];
  const radius = Math.sqrt(1 - z * z);
  return [3 + radius * Math.cos(turn), radius * Math.sin(turn), z];
});
const own = sphere.length + 1;
const positions = Float32Array.from([...sphere, [100, 0, 0]].flat());
const indices = Uint16Array.from(sphere.map((_, i) => i));

it('reaches nearly as far as the shape in each direction, and no farther', () => {
  const points = silhouetteOf({ own, positions, indices, interiorCount: indices.length / 3 });
  expect(points.length).toBeGreaterThan(3 * 100);
  expect(points.length).toBeLessThanOrEqual(3 * 256);
  for (let i = 0; i < 50; ++i) {
    const direction = [Math.sin(i), Math.cos(1.7 * i), Math.sin(2.3 * i)];
    const length = Math.hypot(...direction);
    const reach = (all: ArrayLike<number>, count: number): number =>
      Math.max(...Array.from({ length: count }, (_, k) => direction.reduce((sum, d, axis) => sum + (d / length) * all[3 * k + axis], 0)));
    const whole = reach(positions, sphere.length);
    expect(reach(points, points.length / 3)).toBeLessThanOrEqual(whole);
    expect(reach(points, points.length / 3)).toBeGreaterThan(whole - 0.02);
  }
});

it('has all vertices of what has no triangles, and none of nothing', () => {
  expect(Math.max(...silhouetteOf({ own, positions, indices: new Uint16Array(0), interiorCount: 0 }))).toBe(100);
  expect(silhouetteOf({ own: 0, positions: new Float32Array(0), indices: new Uint16Array(0), interiorCount: 0 })).toHaveLength(0);
});
