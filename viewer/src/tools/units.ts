// SPDX-License-Identifier: MIT
// Units of length. A model's is not known unless its manifest says it, somebody else does, or it is placed on the globe.
import type { Manifest } from '../hierarchy/manifest.js';
import { Coordinates } from './coordinates.js';

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

const DIGITS = 6;

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

/// Two digits, not less.
function roundedUp(bound: number): number {
  const step = 10 ** (Math.floor(Math.log10(bound)) - 1);
  return Number((Math.ceil(bound / step - 1e-9) * step).toPrecision(2));
}

/// `text`: a number, then its unit.
export function within(text: string, bound: number): string {
  return bound > 0 && bound < Infinity ? text.replace(/(?<=[\d.])(?= |°)/, ` ± ${roundedUp(bound)}`) : text;
}

/// How lengths of a model are told: in which unit they are, and in which one they are shown.
export class LengthScale {
  /// A length of the model is multiplied by it.
  readonly factor: number;
  readonly sign: string;

  /// Nothing is converted where one of the two is not known. `unknown`: what an unknown unit is called.
  constructor(
    readonly model: UnitName,
    readonly shown: UnitName,
    unknown = UNITS.unit.sign,
  ) {
    const [from, to] = [UNITS[model].metres, UNITS[shown].metres];
    this.factor = from !== null && to !== null ? from / to : 1;
    const told = from !== null && to !== null ? shown : model;
    this.sign = told === 'unit' ? unknown : UNITS[told].sign;
  }

  /// Six digits: 12.3457 m.
  format(length: number): string {
    return `${Number((length * this.factor).toPrecision(DIGITS))} ${this.sign}`;
  }

  formatArea(area: number): string {
    return `${Number((area * this.factor ** 2).toPrecision(DIGITS))} ${this.sign}²`;
  }

  formatVolume(volume: number): string {
    return `${Number((volume * this.factor ** 3).toPrecision(DIGITS))} ${this.sign}³`;
  }

  /// 12.3457 ± 0.03 m, the bound rounded up; without one that is 0, or not known.
  formatWithin(length: number, bound: number): string {
    return within(this.format(length), bound * this.factor);
  }

  formatAreaWithin(area: number, bound: number): string {
    return within(this.formatArea(area), bound * this.factor ** 2);
  }

  formatVolumeWithin(volume: number, bound: number): string {
    return within(this.formatVolume(volume), bound * this.factor ** 3);
  }
}
