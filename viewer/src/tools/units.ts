// SPDX-License-Identifier: MIT
// Units of length. A model's is not known unless its manifest says it, somebody else does, or it is placed on the globe.
import type { Manifest } from '../hierarchy/manifest.js';
import { Coordinates } from './coordinates.js';
import { figure, plainDecimal, sidesText, type WriteDecimal } from './number_text.js';

export type UnitName = 'unit' | 'mm' | 'cm' | 'm' | 'km' | 'in' | 'ft' | 'ftUS';

interface Unit {
  /// Null: whatever the model's is.
  readonly metres: number | null;
  readonly sign: string;
}

export const UNITS: Readonly<Record<UnitName, Unit>> = {
  unit: { metres: null, sign: 'units' },
  mm: { metres: 0.001, sign: 'mm' },
  cm: { metres: 0.01, sign: 'cm' },
  m: { metres: 1, sign: 'm' },
  km: { metres: 1000, sign: 'km' },
  in: { metres: 0.0254, sign: 'in' },
  ft: { metres: 0.3048, sign: 'ft' },
  ftUS: { metres: 1200 / 3937, sign: 'US ft' },
};

export const UNIT_NAMES = Object.keys(UNITS) as readonly UnitName[];

/// In these a length is told that would have too many zeros in the one that was chosen: from the largest on.
const METRIC: readonly (readonly [metres: number, sign: string])[] = [[1000, 'km'], [1, 'm'], [0.01, 'cm'], [0.001, 'mm'], [1e-6, 'µm'], [1e-9, 'nm']];
const READABLE = { least: 1e-3, most: 1e7 };
const POWERS = ['', '', '²', '³'];

export function isUnitName(value: unknown): value is UnitName {
  return typeof value === 'string' && Object.hasOwn(UNITS, value);
}

/// The unit of that many metres; null: there is none.
export function unitOfMetres(metres: number | null): UnitName | null {
  return UNIT_NAMES.find((name) => metres !== null && Math.abs((UNITS[name].metres ?? 0) - metres) < 1e-9 * metres) ?? null;
}

/// Returns the unit of a model; null: it is not known.
export function unitOfModel(manifest: Manifest): UnitName | null {
  if (manifest.units !== null) return manifest.units === 'us_ft' ? 'ftUS' : manifest.units;
  return unitOfMetres(new Coordinates(manifest).metresPerUnit);
}

/// How lengths of a model are told: in which unit they are, and in which one they are shown.
export class LengthScale {
  /// A length of the model is multiplied by it.
  readonly factor: number;
  readonly sign: string;
  private readonly told: UnitName;

  /// Nothing is converted where one of the two is not known. `unknown`: what an unknown unit is called; `write`: how a language writes numbers.
  constructor(
    readonly model: UnitName,
    readonly shown: UnitName,
    unknown = UNITS.unit.sign,
    private readonly write: WriteDecimal = plainDecimal,
  ) {
    const [from, to] = [UNITS[model].metres, UNITS[shown].metres];
    this.factor = from !== null && to !== null ? from / to : 1;
    this.told = from !== null && to !== null ? shown : model;
    this.sign = this.told === 'unit' ? unknown : UNITS[this.told].sign;
  }

  /// The same without a language.
  get plain(): LengthScale {
    return new LengthScale(this.model, this.shown);
  }

  /// Six digits: 12.3457 m; 0.0000123 m is 12.3 µm.
  format(length: number): string {
    return this.formatPower(length, 0, 1);
  }

  formatArea(area: number): string {
    return this.formatPower(area, 0, 2);
  }

  formatVolume(volume: number): string {
    return this.formatPower(volume, 0, 3);
  }

  /// 12.35 ± 0.03 m, the bound rounded up; without one that is 0, or not known.
  formatWithin(length: number, bound: number): string {
    return this.formatPower(length, bound, 1);
  }

  formatAreaWithin(area: number, bound: number): string {
    return this.formatPower(area, bound, 2);
  }

  formatVolumeWithin(volume: number, bound: number): string {
    return this.formatPower(volume, bound, 3);
  }

  /// 1.5 × 2 × 0.25 m: all in the unit and to the place of the longest.
  formatSides(sides: readonly number[]): string {
    const { factor, sign } = this.readable(Math.max(...sides.map(Math.abs)) * this.factor, 1);
    return `${sidesText(sides.map((side) => side * this.factor * factor), this.write)} ${sign}`.trimEnd();
  }

  private formatPower(value: number, bound: number, power: 1 | 2 | 3): string {
    const [shown, off] = [value, bound].map((each) => each * this.factor ** power);
    const { factor, sign } = this.readable(Math.max(Math.abs(shown), off < Infinity ? off : 0), power);
    return `${figure(shown * factor ** power, { bound: off * factor ** power, write: this.write })} ${sign}${POWERS[power]}`;
  }

  /// Returns the unit in which a size reads well, and what lengths in the shown one are multiplied by for it.
  private readable(size: number, power: 1 | 2 | 3): { factor: number; sign: string } {
    const metres = UNITS[this.told].metres;
    const isReadable = size === 0 || (size >= READABLE.least && size < READABLE.most);
    if (isReadable || metres === null || !METRIC.some(([, sign]) => sign === this.sign)) return { factor: 1, sign: this.sign };
    const [unit, sign] = METRIC.find(([other]) => size * (metres / other) ** power >= 1) ?? METRIC[METRIC.length - 1];
    return { factor: metres / unit, sign };
  }
}
