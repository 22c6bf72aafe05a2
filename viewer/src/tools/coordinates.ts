// SPDX-License-Identifier: MIT
// From the tiles' coordinates to the input's, and to the earth. In double precision: where the input's coordinates fit
// 32-bit floats, what comes out are its own numbers, to the bit.
import type { Manifest } from '../hierarchy/manifest.js';
import { length, vertexAt, type Vector } from './vectors.js';

/// These of a manifest say where a model lies.
export type ModelPlace = Pick<Manifest, 'origin' | 'place' | 'up' | 'transform'>;

/// WGS 84: semi-major axis in metres, flattening.
const EARTH = { axis: 6378137, flattening: 1 / 298.257223563 };
const ECCENTRICITY = EARTH.flattening * (2 - EARTH.flattening); // squared
const ROUNDS = 6; // of the latitude's iteration: each gains two to three digits
const DEGREES = 180 / Math.PI;

export interface GlobePlace {
  /// Degrees, on WGS 84.
  readonly longitude: number;
  readonly latitude: number;
  /// Metres above the ellipsoid.
  readonly height: number;
}

/// A sum that leaves a number as it is, the sign of a zero too, where nothing is added.
function shifted(value: number, ...shifts: readonly number[]): number {
  return shifts.reduce((sum, shift) => (shift === 0 ? sum : sum + shift), value);
}

function map(point: Vector, change: (value: number, axis: number) => number): Vector {
  return [change(point[0], 0), change(point[1], 1), change(point[2], 2)];
}

/// The place of a point of the earth's axes, in metres (iteration of Heiskanen & Moritz 1967).
export function globePlace([x, y, z]: Vector): GlobePlace {
  const across = Math.hypot(x, y);
  let latitude = Math.atan2(z, across * (1 - ECCENTRICITY));
  let normal = EARTH.axis;
  for (let round = 0; round < ROUNDS; ++round) {
    normal = EARTH.axis / Math.sqrt(1 - ECCENTRICITY * Math.sin(latitude) ** 2);
    latitude = Math.atan2(z + ECCENTRICITY * normal * Math.sin(latitude), across);
  }
  const [sine, cosine] = [Math.sin(latitude), Math.cos(latitude)];
  const height = across * cosine + z * sine - normal * (1 - ECCENTRICITY * sine * sine);
  return { longitude: Math.atan2(y, x) * DEGREES, latitude: latitude * DEGREES, height };
}

export class Coordinates {
  constructor(private readonly placement: ModelPlace) {}

  /// From the tiles' coordinates to the input's.
  toInput(point: Vector): Vector {
    const { origin, place } = this.placement;
    return map(point, (value, axis) => shifted(value, place[axis], origin[axis]));
  }

  fromInput(point: Vector): Vector {
    const { origin, place } = this.placement;
    return map(point, (value, axis) => shifted(value, -origin[axis], -place[axis]));
  }

  /// Metres that one unit of the input is; null where the model has no place.
  get metresPerUnit(): number | null {
    const { transform } = this.placement;
    return transform && length(vertexAt(transform, 0));
  }

  /// A point of the input on the globe; null where the model has no place there.
  toGlobe([x, y, z]: Vector): GlobePlace | null {
    const { transform, up } = this.placement;
    if (transform === null) return null;
    const [a, b, c] = up === 'z' ? [x, y, z] : [x, -z, y];
    const row = (k: number): number => transform[k] * a + transform[4 + k] * b + transform[8 + k] * c + transform[12 + k];
    return globePlace([row(0), row(1), row(2)]);
  }
}
