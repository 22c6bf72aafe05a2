// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { boundsOf, measuresOf } from '../../src/tools/measure.js';
import { numbersOf } from '../../page/numbers.js';
import { roundLength, scaleBar, unitsPerPixel } from '../../src/tools/scale_bar.js';
import { isUnitName, LengthScale, unitOfMetres } from '../../src/tools/units.js';
import type { Vector } from '../../src/tools/vectors.js';

/// Spread over a sphere.
const DIRECTIONS = Array.from({ length: 400 }, (_, i): Vector => {
  const z = 1 - (2 * i + 1) / 400;
  return [Math.sqrt(1 - z * z) * Math.cos(2.4 * i), Math.sqrt(1 - z * z) * Math.sin(2.4 * i), z];
});

describe('measuresOf', () => {
  const steps: Vector[] = [[0, 0, 0], [3, 0, 4], [3, 12, 4], [3, 12, 0]];

  it('adds the parts up, in space and in plan, by the axis that is up', () => {
    expect(measuresOf(steps, [0, 1, 0])).toEqual({ parts: [5, 12, 4], length: 21, level: 9, straight: Math.hypot(3, 12), straightLevel: 3, rise: 12, angle: Math.PI / 2, area: Math.hypot(48, 6, 18), areaLevel: 6 });
    expect(measuresOf(steps, [0, 0, 1])).toMatchObject({ length: 21, level: 3 + 12, rise: 0, straightLevel: Math.hypot(3, 12) });
    expect(measuresOf(steps, [0, -1, 0])).toMatchObject({ length: 21, level: 9, rise: -12 });
  });

  it('of one point, and of none, are 0', () => {
    for (const points of [[], steps.slice(1, 2)])
      expect(measuresOf(points, [0, 1, 0])).toEqual({ parts: [], length: 0, level: 0, straight: 0, straightLevel: 0, rise: 0, angle: null, area: null, areaLevel: null });
  });

  it('keeps small lengths far from the origin', () => {
    const far: Vector[] = [[691000.25, 5335000.5, 500], [691000.25, 5335000.5, 500.0009765625]];
    expect(measuresOf(far, [0, 0, 1]).length).toBe(0.0009765625);
  });
});

describe('areas and angles', () => {
  it('are those of the polygon, far from the origin too', () => {
    const court: Vector[] = [[0, 0, 0], [30, 0, 0], [30, 0, 20], [0, 0, 20]].map(([x, y, z]) => [x + 691000, y + 500, z + 5335000]);
    expect(measuresOf(court, [0, 1, 0])).toMatchObject({ area: 600, areaLevel: 600, angle: Math.PI / 2 });
    expect(measuresOf([...court].reverse(), [0, 1, 0])).toMatchObject({ area: 600, areaLevel: 600 });
    const slope = court.map(([x, y, z]): Vector => [x, y + (x - 691000), z]);
    expect(measuresOf(slope, [0, 1, 0]).area).toBeCloseTo(600 * Math.SQRT2, 6);
    expect(measuresOf(slope, [0, 1, 0]).areaLevel).toBeCloseTo(600, 6);
    expect(measuresOf([[0, 0, 0], [1, 0, 0], [1, 1e-3, 0]], [0, 1, 0]).angle).toBeCloseTo(Math.PI / 2, 12);
    expect(measuresOf([[0, 0, 0], [0, 0, 0], [1, 0, 0]], [0, 1, 0]).angle).toBeNull();
  });
});

describe('boundsOf', () => {
  it('of points that are exact is nothing', () => {
    expect(boundsOf([[0, 0, 0], [1, 0, 0], [1, 1, 0]], [0, 0, 0])).toEqual({ parts: [0, 0], length: 0, level: 0, straight: 0, straightLevel: 0, rise: 0, angle: 0, area: 0, areaLevel: 0 });
    expect(boundsOf([], [])).toMatchObject({ length: 0, angle: null, area: null });
  });

  it('is never less than what points do that are off', () => {
    let state = 1;
    const random = (): number => (state = (state * 16807) % 2147483647) / 2147483647;
    const direction = (): Vector => {
      const z = 2 * random() - 1;
      const turn = 2 * Math.PI * random();
      return [Math.sqrt(1 - z * z) * Math.cos(turn), Math.sqrt(1 - z * z) * Math.sin(turn), z];
    };
    let closest = 0;
    for (let round = 0; round < 2000; ++round) {
      const count = 2 + Math.floor(5 * random());
      const points = Array.from({ length: count }, (): Vector => [random(), random(), random()]);
      const errors = points.map(() => 0.2 * random() ** 3);
      const moved = points.map((point, i): Vector => point.map((value, axis) => value + errors[i] * 0.999999 * DIRECTIONS[(round + 7 * i) % DIRECTIONS.length][axis]) as unknown as Vector);
      const up = direction();
      const [is, was, most] = [measuresOf(points, up), measuresOf(moved, up), boundsOf(points, errors)];
      for (const key of ['length', 'level', 'straight', 'straightLevel', 'rise', 'angle', 'area', 'areaLevel'] as const) {
        const off = Math.abs((is[key] ?? 0) - (was[key] ?? 0));
        expect(off).toBeLessThanOrEqual((most[key] ?? 0) + 1e-12);
        if (key === 'area' && (most[key] ?? 0) > 0) closest = Math.max(closest, off / most[key]!);
      }
      is.parts.forEach((part, i) => { expect(Math.abs(part - was.parts[i])).toBeLessThanOrEqual(most.parts[i]); });
    }
    expect(closest).toBeGreaterThan(0.5); // and not much more
  });
});

describe('LengthScale', () => {
  it('tells bounds rounded up, and none that is 0 or not known', () => {
    const scale = new LengthScale('m', 'cm');
    expect(scale.formatWithin(1.234567, 0.01011)).toBe('123.5 ± 1.1 cm');
    expect(scale.formatWithin(1, 0.1)).toBe('100 ± 10 cm');
    expect(scale.formatWithin(1, 0)).toBe('100 cm');
    expect(scale.formatWithin(1, Infinity)).toBe('100 cm');
    expect(scale.formatAreaWithin(2, 0.5)).toBe('20000 ± 5000 cm²');
    expect(scale.formatWithin(0.123456, 0.0003)).toBe('12.35 ± 0.03 cm');
    expect(scale.formatWithin(3, 40)).toBe('0 ± 4000 cm');
  });

  it('takes the unit that reads well where the model has a metric one', () => {
    const metres = new LengthScale('m', 'm');
    expect([1.2345e-4, 5e-4, 3.3e-9, 0.001, 9_999_999, 12_345_678, 0].map((length) => metres.format(length))).toEqual(['123.45 µm', '500 µm', '3.3 nm', '0.001 m', '9999999 m', '12345.7 km', '0 m']);
    expect(metres.formatArea(0.00012317)).toBe('1.2317 cm²');
    expect([metres.formatVolume(4.2e8), metres.formatVolume(4.2e9)]).toEqual(['420000000 m³', '4.2 km³']);
    expect(metres.formatWithin(0, 0.00012)).toBe('0 ± 120 µm');
    expect(metres.formatWithin(0.00012346, 0.0000003)).toBe('123.5 ± 0.3 µm');
    expect(new LengthScale('ft', 'ft').format(0.00012)).toBe('0.00012 ft');
    expect(new LengthScale('unit', 'unit').formatArea(0.00012317)).toBe('123.17\u202f×\u202f10⁻⁶ units²');
  });

  it('tells sides together, to the place of the longest', () => {
    expect(new LengthScale('m', 'm').formatSides([1.5, 2, 5.0001 - 5])).toBe('1.5 × 2 × 0.0001 m');
    expect(new LengthScale('m', 'm').formatSides([1.5e-5, 2e-4, 0])).toBe('15 × 200 × 0 µm');
    expect(new LengthScale('unit', 'unit', '').formatSides([1.25, 2, 3])).toBe('1.25 × 2 × 3');
    expect(new LengthScale('unit', 'unit').formatSides([1.2345e-6, 2e-6, 3e-6])).toBe('(1.2345 × 2 × 3)\u202f×\u202f10⁻⁶ units');
  });

  it.each([['en', '1,234.57 m', '12.35 ± 0.03 m', '0.5 × 2,000 m'], ['de', '1.234,57 m', '12,35 ± 0,03 m', '0,5 × 2.000 m'], ['es', '1234,57 m', '12,35 ± 0,03 m', '0,5 × 2000 m']])('writes as %s does, and plainly for files', (locale, long, bounded, sides) => {
    const scale = new LengthScale('m', 'm', 'units', numbersOf(locale).writeDecimal);
    expect([scale.format(1234.567), scale.formatWithin(12.346, 0.03), scale.formatSides([0.5, 2000])]).toEqual([long, bounded, sides]);
    expect([scale.plain.format(1234.567), scale.plain.formatWithin(12.346, 0.03)]).toEqual(['1234.57 m', '12.35 ± 0.03 m']);
  });

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
