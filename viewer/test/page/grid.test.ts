// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { Grid, type GroupSize, type Metrics } from '../../page/gallery/grid.js';
import { random } from '../support/random.js';

const METRICS: Metrics = { width: 1000, leastWidth: 200, gap: 10, textHeight: 50, headingHeight: 40 };

function plain(count: number): GroupSize {
  return { count, hasHeading: false };
}

describe('a grid', () => {
  it('has as many columns as fit, and at least one', () => {
    expect(new Grid([], METRICS).columns).toBe(4);
    expect(new Grid([], { ...METRICS, width: 1040 }).columns).toBe(5);
    expect(new Grid([], { ...METRICS, width: 0 }).columns).toBe(1);
  });

  it('fills the width, in rows', () => {
    const grid = new Grid([plain(6)], METRICS);
    expect(grid.cellWidth).toBe((1000 - 3 * 10) / 4);
    expect(grid.placeOf({ group: 0, item: 5 })).toEqual({ left: grid.cellWidth + 10, top: grid.cellHeight + 10 });
    expect(grid.height).toBe(2 * grid.cellHeight + 10);
  });

  it('has groups below each other, with room for their names', () => {
    const grid = new Grid([plain(1), { count: 1, hasHeading: true }], METRICS);
    expect(grid.bandOf(1)).toEqual({ top: grid.cellHeight + 10, height: 40 + grid.cellHeight + 10 });
    expect(grid.placeOf({ group: 1, item: 0 })).toEqual({ left: 0, top: 40 });
  });

  it('knows what lies between two heights: no less, and hardly more', () => {
    const next = random(7);
    const extents = Array.from({ length: 300 }, () => ({ count: 1 + Math.floor(next() * 40), hasHeading: next() < 0.5 }));
    const grid = new Grid(extents, METRICS);
    for (let round = 0; round < 50; ++round) {
      const top = next() * grid.height;
      const bottom = top + 900;
      const shown = new Set(grid.runsBetween(top, bottom).flatMap(({ group, first, end }) => Array.from({ length: end - first }, (_, i) => `${group} ${first + i}`)));
      expect(shown.size).toBeLessThan(40);
      extents.forEach(({ count }, group) => {
        for (let item = 0; item < count; ++item) {
          const place = grid.bandOf(group).top + grid.placeOf({ group, item }).top;
          if (place < bottom && place + grid.cellHeight > top) expect(shown.has(`${group} ${item}`)).toBe(true);
        }
      });
    }
  });

  it('has nothing where there is nothing', () => {
    expect(new Grid([], METRICS).runsBetween(0, 1e9)).toEqual([]);
    expect(new Grid([plain(9)], METRICS).runsBetween(1e6, 2e6)).toEqual([]);
  });
});
