import { describe, expect, it } from 'vitest';
import { formatBytes, formatCount, formatDecimal, formatDuration, formatMilliseconds, formatRough } from '../../page/numbers.js';

describe('numbers', () => {
  it.each([[0, '0 B'], [999, '999 B'], [1000, '1.00 kB'], [32768, '32.8 kB'], [999_499, '999 kB'], [999_500, '1.00 MB'],
    [9_994_000, '9.99 MB'], [9_995_000, '10.0 MB'], [23.5e6, '23.5 MB'], [1e20, '100000 PB']])('%d bytes are %s', (value, text) => {
    expect(formatBytes(value)).toBe(text);
  });

  it.each([[0, '0'], [9999, '9,999'], [48485, '48.5 k'], [999_499, '999 k'], [999_500, '1.00 M'], [28_184_526, '28.2 M'],
    [1.2e9, '1.20 G']])('%d is about %s', (value, text) => {
    expect(formatRough(value)).toBe(text);
  });

  it.each([[5, '5 s'], [99.4, '99 s'], [180, '3 min'], [7500, '2 h 5 min']])('%d seconds are %s', (value, text) => {
    expect(formatDuration(value)).toBe(text);
  });

  it('have separators, fractions and units', () => {
    expect(formatCount(28_184_526)).toBe('28,184,526');
    expect(formatDecimal(0.834)).toBe('0.83');
    expect(formatDecimal(12345.6)).toBe('12,346');
    expect(formatMilliseconds(820.4)).toBe('820 ms');
    expect(formatMilliseconds(4250)).toBe('4.25 s');
  });

  it('are a dash where there are none', () => {
    for (const format of [formatBytes, formatCount, formatDecimal, formatDuration, formatMilliseconds, formatRough])
      for (const value of [NaN, Infinity, -1]) expect(format(value)).toBe('–');
  });
});
