// SPDX-License-Identifier: MIT
import { Box3, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { frameWhole } from '../src/scene/framing.js';
import { coveredBox, placeIn } from '../src/scene/poster_place.js';

/// Covers columns [left, right) and rows [top, bottom).
const block = (left: number, top: number, right: number, bottom: number) => (x: number, y: number): number => (x >= left && x < right && y >= top && y < bottom ? 255 : 0);

describe('coveredBox', () => {
  it('finds what is covered', () => {
    expect(coveredBox(block(2, 4, 6, 5), 8)).toEqual({ min: [0.25, 0.5], max: [0.75, 0.625] });
    expect(coveredBox(block(0, 0, 8, 8), 8)).toEqual({ min: [0, 0], max: [1, 1] });
  });

  it('finds nothing in an empty picture', () => {
    expect(coveredBox(() => 0, 8)).toBeNull();
    expect(coveredBox(() => 100, 8)).toBeNull(); // an edge's shine
    expect(coveredBox(() => 255, 0)).toBeNull();
  });
});

describe('placeIn', () => {
  const BOX = { min: [0.1, 0.3], max: [0.9, 0.8] } as const;

  it.each([[390, 844], [800, 600], [100, 100], [2000, 200]])('has the model in the middle of %i x %i, as large as it may be', (width, height) => {
    const { left, top, side } = placeIn(BOX, width, height);
    expect(left + side * 0.5).toBeCloseTo(width / 2);
    expect(top + side * 0.55).toBeCloseTo(height / 2);
    expect(Math.max((0.8 * side) / width, (0.5 * side) / height)).toBeCloseTo(1 / 1.08);
  });

  it('agrees with the first camera without perspective', () => {
    const [width, height, angle] = [500, 300, 1e-4];
    const box = new Box3(new Vector3(-4, -2.5, -1), new Vector3(4, 2.5, 1));
    const { position, target } = frameWhole([], box, [0, 0, 1], angle, width / height);
    const pixels = height / (2 * position.distanceTo(target) * Math.tan(angle / 2)); // a unit
    expect(placeIn(BOX, width, height).side * 0.8).toBeCloseTo(8 * pixels, 1);
  });
});
