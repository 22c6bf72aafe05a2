// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { RayProbe } from '../../src/tools/ray.js';
import { TriangleTree } from '../../src/tools/triangle_tree.js';
import { distanceOf, scale, subtract, type Vector } from '../../src/tools/vectors.js';
import { random } from '../support/random.js';

const SQUARE = Float32Array.of(0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0);

function soup(triangles: number, seed: number): { positions: Float32Array; corners: Uint16Array } {
  const next = random(seed);
  const positions = new Float32Array(9 * triangles);
  for (let t = 0; t < triangles; ++t) {
    const middle = [next(), next(), next()];
    for (let k = 0; k < 9; ++k) positions[9 * t + k] = middle[k % 3] + 0.2 * (next() - 0.5);
  }
  return { positions, corners: Uint16Array.from({ length: 3 * triangles }, (_, i) => i) };
}

/// By all triangles, one after the other.
function nearest(probe: RayProbe, positions: Float32Array, corners: Uint16Array): number {
  let least = Infinity;
  for (let i = 0; i < corners.length; i += 3) least = Math.min(least, probe.hits(positions, corners[i], corners[i + 1], corners[i + 2]));
  return least;
}

describe('a ray and a triangle', () => {
  it('meet at the point that the weights tell, from either side', () => {
    for (const [from, direction] of [[[0.75, 0.25, 3], [0, 0, -2]], [[0.75, 0.25, -3], [0, 0, 0.5]]] as [Vector, Vector][]) {
      const probe = new RayProbe({ from, direction });
      expect(probe.hits(SQUARE, 0, 1, 2)).toBe(3);
      expect(probe.weights).toEqual([0.25, 0.5, 0.25]);
      expect(probe.hits(SQUARE, 0, 2, 3)).toBe(Infinity);
    }
  });

  it('do not meet behind the eye, nor where there is no area', () => {
    expect(new RayProbe({ from: [0.75, 0.25, -1], direction: [0, 0, -1] }).hits(SQUARE, 0, 1, 2)).toBe(Infinity);
    expect(new RayProbe({ from: [0.5, 0, 1], direction: [0, 0, -1] }).hits(SQUARE, 0, 1, 1)).toBe(Infinity);
  });

  it('are exact where floats would not be', () => {
    const far = 2 ** 23; // floats there are whole numbers
    const positions = Float32Array.of(far, 0, 0, far, 1, 0, far, 0, 1);
    expect(new RayProbe({ from: [0.125, 0.25, 0.25], direction: [1, 0, 0] }).hits(positions, 0, 1, 2)).toBe(far - 0.125);
  });

  it('never miss a surface at an edge that two triangles share', () => {
    const next = random(7);
    for (let i = 0; i < 20_000; ++i) {
      const positions = Float32Array.from({ length: 12 }, () => 100 * next() - 50);
      const part = next();
      const on = [0, 1, 2].map((axis) => positions[axis] * part + positions[6 + axis] * (1 - part)) as unknown as Vector;
      const from: Vector = [next() * 300, next() * 300, next() * 300];
      const probe = new RayProbe({ from, direction: subtract(on, from) });
      // The two others on different sides of the plane of ray and edge: else the edge is a fold's outline, and may be missed.
      const side = (vertex: number): number => sideOf(positions, vertex, from);
      if (side(1) * side(3) >= 0) continue;
      const reached = Math.min(probe.hits(positions, 0, 1, 2), probe.hits(positions, 0, 2, 3));
      expect(reached).toBeLessThan(Infinity);
    }
  });
});

/// Tells on which side of the plane through `from` and the vertices 0 and 2 a vertex lies.
function sideOf(positions: Float32Array, vertex: number, from: Vector): number {
  const [a, b, c] = [0, 2, vertex].map((each) => subtract([positions[3 * each], positions[3 * each + 1], positions[3 * each + 2]], from));
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

describe('a ray and a box', () => {
  const box = [0, 0, 0, 1, 2, 3];
  it('meet at its entry, at 0 inside, along its sides, and behind it not', () => {
    const enters = (from: Vector, direction: Vector): number => new RayProbe({ from, direction }).enters(box);
    expect(enters([-2, 1, 1], [5, 0, 0])).toBe(2);
    expect(enters([0.5, 1, 1], [0, 0, -1])).toBe(0);
    expect(enters([0, -1, 0], [0, 1, 0])).toBe(1);
    expect(enters([2, 1, 1], [1, 0, 0])).toBe(Infinity);
    expect(enters([-2, 3, 1], [1, 0, 0])).toBe(Infinity);
    expect(new RayProbe({ from: [0, 0, 2], direction: [0, 0, -1] }).enters([0, 0, 1, 0, 0, 1])).toBe(1);
  });
});

describe('TriangleTree', () => {
  it.each([1, 2, 7, 8, 9, 300, 4000])('finds among %d triangles what looking at all of them finds', (triangles) => {
    const { positions, corners } = soup(triangles, triangles);
    const tree = new TriangleTree(positions, corners, triangles);
    const next = random(3);
    let looked = 0;
    for (let i = 0; i < 200; ++i) {
      const from: Vector = [4 * next() - 1.5, 4 * next() - 1.5, 4 * next() - 1.5];
      const probe = new RayProbe({ from, direction: subtract([next(), next(), next()], from) });
      let least = Infinity;
      tree.visit(probe, Infinity, (t) => {
        ++looked;
        return (least = Math.min(least, probe.hits(positions, corners[3 * t], corners[3 * t + 1], corners[3 * t + 2])));
      });
      expect(least).toBe(nearest(probe, positions, corners));
    }
    if (triangles > 1000) expect(looked / 200).toBeLessThan(triangles / 4);
    expect(tree.bytes).toBeLessThan(20 * triangles + 200);
  });

  it('of nothing is met by nothing', () => {
    const tree = new TriangleTree(new Float32Array(0), new Uint16Array(0), 0);
    tree.visit(new RayProbe({ from: [0, 0, 0], direction: [1, 0, 0] }), Infinity, () => { throw new Error('there is none'); });
    expect(distanceOf([0, 0, 0], scale([1, 0, 0], 2))).toBe(2);
  });
});
