// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { numbersOf } from '../../page/numbers.js';
import { safeLink } from '../../page/tools/object_card.js';

describe('a value of an object', () => {
  it.each(['https://example.org/a?b=<c>', 'http://example.org', 'HTTPS://EXAMPLE.ORG/%20'])('is a link: %s', (text) => {
    expect(safeLink(text)).toMatch(/^https?:\/\//);
    expect(safeLink(text)).not.toMatch(/[<>"\s]/);
  });

  it.each(['javascript:alert(1)', 'data:text/html,<b>', 'https://', 'see https://example.org', 'https://a b', ' https://example.org', 'file:///etc/passwd', '//example.org', ''])('is a text alone: %s', (text) => {
    expect(safeLink(text)).toBeNull();
  });

  it('is a number as people write it', () => {
    const told = (value: number, locale = 'en'): string => numbersOf(locale).formatNumber(value);
    expect([0, -1234.5, 0.1 + 0.2, 1234567.891, 1e-7, 2 ** 60, NaN].map((value) => told(value))).toEqual(['0', '-1,234.5', '0.3', '1,234,567.891', '100\u202f×\u202f10⁻⁹', '1.15292150461\u202f×\u202f10¹⁸', '–']);
    expect(told(1234567.891, 'de')).toBe('1.234.567,891');
  });
});
