// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { formatBytes, formatCount, formatDate, formatDecimal, formatDuration, formatMilliseconds, formatPercent, formatRough, numbersOf } from '../../page/numbers.js';

describe('numbers', () => {
  it.each([[0, '0 byte'], [999, '999 byte'], [1000, '1.00 kB'], [32768, '32.8 kB'], [999_499, '999 kB'], [999_500, '1.00 MB'],
    [9_994_000, '9.99 MB'], [9_995_000, '10.0 MB'], [23.5e6, '23.5 MB'], [1e20, '100,000 PB']])('%d bytes are %s', (value, text) => {
    expect(formatBytes(value)).toBe(text);
  });

  it.each([[0, '0'], [9999, '9,999'], [48485, '48.5K'], [999_499, '999K'], [999_500, '1.00M'], [28_184_526, '28.2M'],
    [1.2e9, '1.20B']])('%d is about %s', (value, text) => {
    expect(formatRough(value)).toBe(text);
  });

  it.each([[5, '5 sec'], [99.4, '99 sec'], [180, '3 min'], [7500, '2 hr 5 min']])('%d seconds are %s', (value, text) => {
    expect(formatDuration(value)).toBe(text);
  });

  it('have separators, fractions and units', () => {
    expect(formatCount(28_184_526)).toBe('28,184,526');
    expect(formatPercent(0.417)).toBe('42%');
    expect(formatDecimal(0.834)).toBe('0.83');
    expect(formatDecimal(12345.6)).toBe('12,346');
    expect(formatMilliseconds(820.4)).toBe('820 ms');
    expect(formatMilliseconds(4250)).toBe('4.25 sec');
  });

  it('are written as the language does', () => {
    const [german, spanish] = [numbersOf('de'), numbersOf('es')];
    expect(german.formatCount(28_184_526)).toBe('28.184.526');
    expect(german.formatRough(28_184_526)).toMatch(/^28,2\sMio\.$/);
    expect(german.formatDuration(7500)).toMatch(/^2\sStd\. 5\sMin\.$/);
    expect(spanish.formatRough(48485)).toMatch(/^48,5\smil$/);
    expect(spanish.formatBytes(23.5e6)).toMatch(/^23,5\sMB$/);
  });

  it('are days', () => {
    expect(formatDate(1_790_000_000)).toMatch(/Sep 2\d, 2026/);
  });

  it('are a dash where there are none', () => {
    for (const format of [formatDate, formatBytes, formatCount, formatDecimal, formatDuration, formatMilliseconds, formatPercent, formatRough])
      for (const value of [NaN, Infinity, -1]) expect(format(value)).toBe('–');
    expect(formatDate(1e300)).toBe('–');
  });
});
