// SPDX-License-Identifier: MIT
// Numbers for people, as their language writes them. Every function takes any number, and what is no number becomes a dash.
import { locale } from './words/words.js';

const DASH = '–';
const UNITS = ['byte', 'kilobyte', 'megabyte', 'gigabyte', 'terabyte', 'petabyte'] as const;
const LAST_SECOND = 8.64e12; // since 1970, that dates know
const NUMBER_DIGITS = 12;
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
  /// Four digits: 0.001235, 12.35, 123,500.
  readonly formatLength: (value: number) => string;
  /// Any number, in up to twelve digits: 1,234.5; very large and small ones as powers of ten: 1.2E-7.
  readonly formatNumber: (value: number) => string;
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
  const length = formats({ maximumSignificantDigits: 4 });
  const plain = formats({ maximumSignificantDigits: NUMBER_DIGITS });
  const power = formats({ maximumSignificantDigits: NUMBER_DIGITS, notation: 'scientific' });
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
    formatLength: orDash(length),
    formatNumber: (value) => (!Number.isFinite(value) ? DASH : value === 0 || (Math.abs(value) >= 1e-6 && Math.abs(value) < 1e15) ? plain(value) : power(value)),
    formatPercent: orDash(percent),
    formatDate: orDash((seconds) => (seconds < LAST_SECOND ? day.format(1000 * seconds) : DASH)),
  };
}

export const { formatCount, formatRough, formatBytes, formatMilliseconds, formatDuration, formatDecimal, formatLength, formatNumber, formatPercent, formatDate } = numbersOf(locale);
