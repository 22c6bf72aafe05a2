// SPDX-License-Identifier: MIT
// Numbers as a person writes them.
//
// Problem: a double has 17 digits, of which a measurement means four; "0.00012317" makes the reader count zeros; and a bound of 0.03 says that the digits
//   behind the second are noise.
// Idea: a number ends at a decimal place. A bound gives it: it is rounded up to one digit (two where it begins with 1 or 2), and the value ends where the
//   bound does. Without one there are six digits. What would be a row of zeros has a power of ten that is a multiple of three.
//
//     12.3456 ± 0.0271  ->  12.346 ± 0.028         0.00012317  ->  123.17 × 10⁻⁶
//     12.3456 ± 0.03    ->  12.35 ± 0.03           (123.2 ± 0.4) × 10⁻⁶
//
// Invariant: a bound is never written smaller than it is. The signs between digits are the writer's alone: the library knows no languages.

/// Writes a number with at most so many digits behind the point, and at least `least`.
export type WriteDecimal = (value: number, most: number, least: number) => string;

export interface FigureOptions {
  /// How far off the value may be; 0 and Infinity are not told.
  readonly bound?: number;
  readonly write?: WriteDecimal;
  /// The last place, as a power of ten, of a value whose bound is not told; six digits without it.
  readonly place?: number;
}

const DIGITS = 6;
const MOST_DIGITS = 12; // of a value with a bound: what is beyond is the rounding of doubles
const MOST_PLACES = 100; // that browsers write
const LEAST_PLAIN = 1e-3;
const MOST_PLAIN = 1e10; // coordinates of maps have eight digits before the point
const MOST_PLAIN_PLACES = 5; // of what is smaller: 0.0005 and 0.00012
const LEAST_POWER = -300;
const NARROW = '\u202f'; // a thin space at which no line ends
const RAISED = '⁰¹²³⁴⁵⁶⁷⁸⁹';

/// Without a language: a point, no separators.
export const plainDecimal: WriteDecimal = (value, most, least) => {
  const text = value.toFixed(most);
  if (most === least || !text.includes('.')) return text;
  const [whole, fraction] = text.split('.');
  const kept = fraction.replace(/0+$/, '').padEnd(least, '0');
  return kept === '' ? whole : `${whole}.${kept}`;
};

/// The power of ten of a number's first digit.
export function magnitude(value: number): number {
  return value === 0 ? 0 : Number(value.toExponential().split('e')[1]);
}

/// As 10 ** exponent, and exactly the number that its text is.
function powerOfTen(exponent: number): number {
  return Number(`1e${exponent}`);
}

function places(place: number): number {
  return Math.min(Math.max(-place, 0), MOST_PLACES);
}

/// The bound in one digit, in two where the first is 1 or 2, not less; and the place of the last one.
export function roundedBound(bound: number): { bound: number; place: number } {
  const first = magnitude(bound);
  const place = Number(bound.toExponential(11).split('e')[0]) < 3 ? first - 1 : first;
  return { bound: Number(`${Math.ceil(Number((bound / powerOfTen(place)).toPrecision(12)))}e${place}`), place };
}

/// Rounded to a place that may lie before the point.
function atPlace(value: number, place: number): number {
  return place > 0 ? Math.round(value / powerOfTen(place)) * powerOfTen(place) : place < -MOST_PLACES ? value : Number(value.toFixed(-place));
}

/// The multiple of three that a number's power of ten is written with; 0: without. `place`: up to which it is told.
function powerFor(size: number, place: number): number {
  const isShort = place >= -MOST_PLAIN_PLACES && Number(size.toFixed(MOST_PLAIN_PLACES)) === Number(size.toPrecision(DIGITS));
  const isPlain = size === 0 || isShort || (size >= LEAST_PLAIN && size < MOST_PLAIN);
  return isPlain && size < MOST_PLAIN ? 0 : Math.max(3 * Math.floor(magnitude(size) / 3), LEAST_POWER);
}

function powerText(power: number): string {
  if (power === 0) return '';
  const digits = String(Math.abs(power)).replace(/\d/g, (digit) => RAISED[Number(digit)]);
  return `${NARROW}×${NARROW}10${power < 0 ? '⁻' : ''}${digits}`;
}

/// Returns the bound as it is told, with its last place; null: none is.
function toldBound(value: number, bound: number): { bound: number; place: number } | null {
  if (!(bound > 0 && bound < Infinity)) return null;
  const told = roundedBound(bound);
  return value !== 0 && told.place <= magnitude(value) - MOST_DIGITS ? null : told;
}

/// Returns a value's own last place: whole numbers keep their digits.
function ownPlace(value: number, digits = DIGITS): number {
  return Math.min(magnitude(value) - digits + 1, 0);
}

/// Writes numbers that end at one place, divided by a power of ten.
function digitsAt(place: number, power: number, write: WriteDecimal): (value: number, isPadded: boolean) => string {
  const most = places(place - power);
  return (value, isPadded) => {
    const rounded = atPlace(value, place);
    const shifted = power < 0 ? rounded * powerOfTen(-power) : rounded / powerOfTen(power);
    return write(Math.abs(shifted) < 0.5 * powerOfTen(-most) ? 0 : shifted, most, isPadded ? most : 0);
  };
}

/// 12.35 ± 0.03; 123.17 × 10⁻⁶; what is no number is a dash.
export function figure(value: number, { bound = 0, write = plainDecimal, place: last }: FigureOptions = {}): string {
  if (!Number.isFinite(value)) return '–';
  const told = toldBound(value, bound);
  const place = told?.place ?? last ?? ownPlace(value, bound > 0 && bound < Infinity ? MOST_DIGITS : DIGITS);
  const power = powerFor(atPlace(Math.max(Math.abs(value), told?.bound ?? 0), place), told?.place ?? 0);
  const digits = digitsAt(place, power, write);
  if (told === null) return `${digits(value, false)}${powerText(power)}`;
  const text = `${digits(value, true)} ± ${digits(told.bound, true)}`;
  return power === 0 ? text : `(${text})${powerText(power)}`;
}

/// 1.5 × 2 × 0.25; (1.5 × 2 × 0.25) × 10⁻⁶: all to the place of the longest.
export function sidesText(sides: readonly number[], write: WriteDecimal = plainDecimal): string {
  const longest = Math.max(...sides.map(Math.abs));
  const power = powerFor(longest, 0);
  const digits = digitsAt(ownPlace(longest), power, write);
  const text = sides.map((side) => digits(side, false)).join(' × ');
  return power === 0 ? text : `(${text})${powerText(power)}`;
}
