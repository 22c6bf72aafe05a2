// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { figure, magnitude, plainDecimal, roundedBound, sidesText } from '../../src/tools/number_text.js';
import { numbersOf } from '../../page/numbers.js';

const NARROW = '\u202f';

function told(value: number, bound = 0): string {
  return figure(value, { bound }).replaceAll(NARROW, ' ');
}

describe('a figure', () => {
  it.each([[12.346, 0.03, '12.35 ± 0.03'], [12.3456, 0.0271, '12.346 ± 0.028'], [12.3456, 0.0999, '12.35 ± 0.10'], [123456.789012345, 1e-9, '123456.789012'], [0, 0.5, '0.0 ± 0.5'], [-12.346, 0.03, '-12.35 ± 0.03'],
    [20123, 4321, '20000 ± 5000'], [1.5, 12, '2 ± 12'], [1e-5, 3e-5, '0.00001 ± 0.00003'], [0.0001234567, 0.0000004, '(123.5 ± 0.4) × 10⁻⁶'],
    [691000.2512345, 0.0004, '691000.2512 ± 0.0004'], [1, 1e-12, '1'], [1, Infinity, '1'], [1, NaN, '1']])('of %d ± %d is %s', (value, bound, text) => {
    expect(told(value, bound)).toBe(text);
  });

  it.each([[0.00012317, '123.17 × 10⁻⁶'], [0.0005, '0.0005'], [0.00012, '0.00012'], [0.000125, '125 × 10⁻⁶'], [1e-7, '100 × 10⁻⁹'], [1e10, '10 × 10⁹'], [1234567, '1234567'], [-0, '0'],
    [123456.789, '123457'], [12.3456789, '12.3457'], [1e-300, '1 × 10⁻³⁰⁰'], [1.5e300, '1.5 × 10³⁰⁰'], [-0.00012317, '-123.17 × 10⁻⁶'], [NaN, '–'], [-Infinity, '–']])('of %d is %s', (value, text) => {
    expect(told(value)).toBe(text);
  });

  it('ends at a place that is given', () => {
    expect([-2, 0, 3].map((place) => figure(1234.5678, { place }))).toEqual(['1234.57', '1235', '1000']);
    expect(figure(0.30000001192092896, { place: -8 })).toBe('0.30000001');
    expect(figure(32_691_000.25, { place: -3 })).toBe('32691000.25');
    expect(figure(-1e-9, { place: -3 })).toBe('0');
  });

  it('is written as its language does', () => {
    const bounds = (locale: string): string => figure(1234.5678, { bound: 0.03, write: numbersOf(locale).writeDecimal });
    expect(['en', 'de', 'es'].map(bounds)).toEqual(['1,234.57 ± 0.03', '1.234,57 ± 0,03', '1234,57 ± 0,03']);
    expect(figure(0.00012317, { write: numbersOf('de').writeDecimal })).toBe(`123,17${NARROW}×${NARROW}10⁻⁶`);
  });
});

describe('a bound', () => {
  it('is never told smaller than it is, and less than a half more', () => {
    for (let i = 0; i < 5000; ++i) {
      const bound = 10 ** ((i % 37) - 18) * (1 + (9 * i) / 5000);
      const { bound: rounded, place } = roundedBound(bound);
      expect(rounded).toBeGreaterThanOrEqual(bound * (1 - 1e-11));
      expect(rounded).toBeLessThan(bound * 1.34);
      expect(magnitude(rounded) - place).toBeLessThanOrEqual(1);
    }
  });
});

describe('sides', () => {
  it('end at the place of the longest', () => {
    expect(sidesText([123.4567, 0.1234567, 0])).toBe('123.457 × 0.123 × 0');
    expect(sidesText([0, 0, 0])).toBe('0 × 0 × 0');
  });
});

describe('a decimal without a language', () => {
  it('has zeros only where they are asked for', () => {
    expect([[1.5, 3, 0], [1.5, 3, 3], [2, 3, 0], [100, 0, 0], [1.5, 3, 2]].map(([value, most, least]) => plainDecimal(value, most, least))).toEqual(['1.5', '1.500', '2', '100', '1.50']);
  });
});
