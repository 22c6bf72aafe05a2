// SPDX-License-Identifier: MIT
// Numbers for people, as their language writes them. Every function takes any number, and what is no number becomes a dash.
import { figure, magnitude, type WriteDecimal } from '../src/tools/number_text.js';
import { locale } from './words/words.js';

const DASH = '–';
const UNITS = ['byte', 'kilobyte', 'megabyte', 'gigabyte', 'terabyte', 'petabyte'] as const;
const LAST_SECOND = 8.64e12; // since 1970, that dates know
const NUMBER_DIGITS = 12;
const FLOAT_DIGITS = 7; // that a decimal keeps in a float
const THREE_DIGITS = { minimumSignificantDigits: 3, maximumSignificantDigits: 3 } as const;

type NumberUnit = (typeof UNITS)[number] | 'millisecond' | 'second' | 'minute' | 'hour';

export interface Numbers {
  /// 28,184,526.
  readonly formatCount: (value: number) => string;
  /// 28.2M.
  readonly formatRough: (value: number) => string;
  /// 23.5 MB, in powers of 1000.
  readonly formatBytes: (value: number) => string;
  /// 820 ms, 4.25 sec.
  readonly formatMilliseconds: (value: number) => string;
  /// 12 sec, 3 min, 2 hr 5 min.
  readonly formatDuration: (seconds: number) => string;
  /// 0.83, 12.5; large ones without a fraction.
  readonly formatDecimal: (value: number) => string;
  /// Any number, in up to twelve digits: 1,234.5; very large and small ones with powers of ten: 120 × 10⁻⁹.
  readonly formatNumber: (value: number) => string;
  /// The same of a float, which has seven.
  readonly formatFloat: (value: number) => string;
  /// How the language writes the digits of a number.
  readonly writeDecimal: WriteDecimal;
  /// A part from 0 to 1: 42%.
  readonly formatPercent: (value: number) => string;
  /// The day of seconds since 1970: Nov 24, 2026.
  readonly formatDate: (seconds: number) => string;
}

function isSize(value: number): boolean {
  return Number.isFinite(value) && value >= 0;
}

/// 1.23, 12.3, 123.
function fractionDigits(value: number): number {
  return value < 9.995 ? 2 : value < 99.95 ? 1 : 0;
}

/// Makes a format for each count of digits that is asked for.
function decimalsOf(locale: string): WriteDecimal {
  const made = new Map<string, Intl.NumberFormat>();
  return (value, most, least) => {
    const key = `${most} ${least}`;
    const format = made.get(key) ?? new Intl.NumberFormat(locale, { minimumFractionDigits: least, maximumFractionDigits: most });
    made.set(key, format);
    return format.format(value);
  };
}

/// As a language writes them.
export function numbersOf(locale: string): Numbers {
  const formats = (options: Intl.NumberFormatOptions = {}): ((value: number) => string) => {
    const format = new Intl.NumberFormat(locale, options);
    return (value) => format.format(value);
  };
  const unit = (name: NumberUnit, options: Intl.NumberFormatOptions = {}) => formats({ style: 'unit', unit: name, ...options });
  const count = formats({ maximumFractionDigits: 0 });
  const compact = formats({ notation: 'compact', ...THREE_DIGITS });
  const day = new Intl.DateTimeFormat(locale, { dateStyle: 'medium' });
  const writeDecimal = decimalsOf(locale);
  const digits = (count: number) => (value: number) => figure(Number(value.toPrecision(count)), { write: writeDecimal, place: magnitude(value) - count + 1 });
  const percent = formats({ style: 'percent', maximumFractionDigits: 0 });
  const decimals = [0, 1, 2].map((digits) => formats({ minimumFractionDigits: digits, maximumFractionDigits: digits }));
  const bytes = UNITS.map((name, i) => unit(name, i === 0 ? { maximumFractionDigits: 0 } : THREE_DIGITS));
  const [milliseconds, wholeSeconds, minutes, hours] = (['millisecond', 'second', 'minute', 'hour'] as const).map(
    (name) => unit(name, { maximumFractionDigits: 0 }));
  const seconds = unit('second', THREE_DIGITS);

  function sized(value: number): string {
    let power = 0;
    for (; value >= 999.5 && power < UNITS.length - 1; ++power) value /= 1000;
    return bytes[power](value);
  }

  function duration(value: number): string {
    if (value < 99.5) return wholeSeconds(value);
    const whole = Math.round(value / 60);
    return whole < 60 ? minutes(whole) : `${hours(Math.floor(whole / 60))} ${minutes(whole % 60)}`;
  }

  const orDash = (format: (value: number) => string) => (value: number): string => (isSize(value) ? format(value) : DASH);
  return {
    formatCount: orDash(count),
    formatRough: orDash((value) => (value < 10_000 ? count(value) : compact(value))),
    formatBytes: orDash(sized),
    formatMilliseconds: orDash((value) => (value < 999.5 ? milliseconds(value) : seconds(value / 1000))),
    formatDuration: orDash(duration),
    formatDecimal: orDash((value) => (value >= 1000 ? count(value) : decimals[fractionDigits(value)](value))),
    formatNumber: (value) => (Number.isFinite(value) ? digits(NUMBER_DIGITS)(value) : DASH),
    formatFloat: (value) => (Number.isFinite(value) ? digits(FLOAT_DIGITS)(value) : DASH),
    writeDecimal,
    formatPercent: orDash(percent),
    formatDate: orDash((seconds) => (seconds < LAST_SECOND ? day.format(1000 * seconds) : DASH)),
  };
}

export const { formatCount, formatRough, formatBytes, formatMilliseconds, formatDuration, formatDecimal, formatNumber, formatFloat, formatPercent, formatDate, writeDecimal } = numbersOf(locale);
