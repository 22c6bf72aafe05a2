// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { measuresOf } from '../../src/tools/measure.js';
import { roundLength, scaleBar, unitsPerPixel } from '../../src/tools/scale_bar.js';
import { isUnitName, LengthScale, unitOfMetres } from '../../src/tools/units.js';
import type { Vector } from '../../src/tools/vectors.js';

describe('measuresOf', () => {
  const steps: Vector[] = [[0, 0, 0], [3, 0, 4], [3, 12, 4], [3, 12, 0]];

  it('adds the parts up, in space and in plan, by the axis that is up', () => {
    expect(measuresOf(steps, [0, 1, 0])).toEqual({ parts: [5, 12, 4], length: 21, level: 9, straight: Math.hypot(3, 12), straightLevel: 3, rise: 12 });
    expect(measuresOf(steps, [0, 0, 1])).toMatchObject({ length: 21, level: 3 + 12, rise: 0, straightLevel: Math.hypot(3, 12) });
    expect(measuresOf(steps, [0, -1, 0])).toMatchObject({ length: 21, level: 9, rise: -12 });
  });

  it('of one point, and of none, are 0', () => {
    for (const points of [[], steps.slice(1, 2)])
      expect(measuresOf(points, [0, 1, 0])).toEqual({ parts: [], length: 0, level: 0, straight: 0, straightLevel: 0, rise: 0 });
  });

  it('keeps small lengths far from the origin', () => {
    const far: Vector[] = [[691000.25, 5335000.5, 500], [691000.25, 5335000.5, 500.0009765625]];
    expect(measuresOf(far, [0, 0, 1]).length).toBe(0.0009765625);
  });
});

describe('LengthScale', () => {
  it('converts where both units are known', () => {
    expect(new LengthScale('m', 'ft').format(0.3048)).toBe('1 ft');
    expect(new LengthScale('mm', 'm').format(1234567)).toBe('1234.57 m');
    expect(new LengthScale('m', 'cm').formatArea(2)).toBe('20000 cm²');
    expect(new LengthScale('ftUS', 'm').format(3937)).toBe('1200 m');
  });

  it('tells lengths as they are where one is not', () => {
    expect(new LengthScale('unit', 'm').format(2.5)).toBe('2.5 units');
    expect(new LengthScale('mm', 'unit').format(2.5)).toBe('2.5 mm');
  });

  it('knows the units of placed models', () => {
    expect(unitOfMetres(1)).toBe('m');
    expect(unitOfMetres(0.3048 * (1 + 1e-12))).toBe('ft');
    expect([unitOfMetres(0.5), unitOfMetres(null)]).toEqual([null, null]);
    expect([isUnitName('ft'), isUnitName('constructor'), isUnitName(3)]).toEqual([true, false, false]);
  });
});

describe('the scale bar', () => {
  it.each([[9.99, 5], [10, 10], [0.0021, 0.002], [0.3, 0.2], [1e-12, 1e-12], [49_999, 20_000], [1000, 1000]])('of at most %d is %d long', (most, length) => {
    expect(roundLength(most)).toBe(length);
  });

  it('is as long as its length is at the depth', () => {
    const perPixel = unitsPerPixel(10, 1 / Math.tan(Math.PI / 8), 800); // 45 degrees
    expect(perPixel * 800).toBeCloseTo(2 * 10 * Math.tan(Math.PI / 8), 12);
    const bar = scaleBar(perPixel, 150, new LengthScale('m', 'cm'))!;
    expect(bar.text).toBe('100 cm');
    expect(bar.pixels * perPixel).toBeCloseTo(1, 12);
    expect(bar.pixels).toBeLessThanOrEqual(150);
  });

  it('is not there where nothing can be told', () => {
    for (const perPixel of [0, NaN, Infinity, -1]) expect(scaleBar(perPixel, 150, new LengthScale('m', 'm'))).toBeNull();
  });
});
