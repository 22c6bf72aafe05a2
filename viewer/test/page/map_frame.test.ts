// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { clustersOf, frameOf, lineStep, linesWithin, moved, toMap, zoomed } from '../../page/gallery/map_frame.js';
import type { ModelSpot } from '../../page/listing.js';

const SIZE = { width: 800, height: 600 };
const SPOTS: ModelSpot[] = [[11.25, 43.77, 0], [11.26, 43.78, 1], [2.35, 48.85, 2], [-58.4, -34.6, 3]];

describe('the map', () => {
  it('has all spots in view', () => {
    for (const spots of [SPOTS, SPOTS.slice(0, 2), SPOTS.slice(0, 1), []]) {
      const frame = frameOf(spots, SIZE);
      for (const spot of spots) {
        const [x, y] = toMap(frame, SIZE, spot);
        expect(x >= 0 && x <= SIZE.width && y >= 0 && y <= SIZE.height).toBe(true);
      }
    }
  });

  it('has each spot in one mark, and marks that stay together when it is moved', () => {
    const frame = frameOf(SPOTS, SIZE);
    const clusters = clustersOf(SPOTS, frame, SIZE);
    expect(clusters.flatMap(({ spots }) => spots.map(([, , index]) => index)).sort()).toEqual([0, 1, 2, 3]);
    const sorts = (all: typeof clusters): string[] => all.map(({ spots }) => spots.map(([, , index]) => index).join()).sort();
    expect(sorts(clustersOf(SPOTS, moved(frame, 7, 0), SIZE))).toEqual(sorts(clusters));
    const near = frameOf(SPOTS.slice(0, 2), SIZE);
    expect(sorts(clustersOf(SPOTS, near, SIZE))).toEqual(['0', '1']);
    expect(clustersOf([[5, 5, 0], [5, 5, 1]], zoomed(frame, 1e9, SIZE, [400, 300]), SIZE)).toEqual([]);
  });

  it('is enlarged about a place, which stays there', () => {
    const frame = frameOf(SPOTS, SIZE);
    const [x, y] = toMap(frame, SIZE, SPOTS[2]);
    const [a, b] = toMap(zoomed(frame, 4, SIZE, [x, y]), SIZE, SPOTS[2]);
    expect(Math.abs(b - y)).toBeLessThan(1);
    expect(Math.abs(a - x)).toBeLessThan(60); // degrees of longitude are as wide as at the new middle
  });

  it('has lines at round numbers', () => {
    expect([1, 3, 10, 100, 5000, 1e7].map(lineStep)).toEqual([45, 30, 10, 1, 0.02, 0.00001]);
    expect(linesWithin(-11, 12, 5)).toEqual([-10, -5, 0, 5, 10]);
    expect(linesWithin(43.771, 43.7741, 0.001)).toEqual([43.771, 43.772, 43.773, 43.774]);
    expect(linesWithin(5, 4, 1)).toEqual([]);
  });
});
