// SPDX-License-Identifier: MIT
// Tells of a point that was picked.
import type { Manifest } from '../hierarchy/manifest.js';
import { isLabel, LEAST_VALUE, labelName, type ScalarAttribute } from '../hierarchy/scalar_values.js';
import { Coordinates, type GlobePlace } from './coordinates.js';
import { magnitude } from './number_text.js';
import type { Hit } from './pick.js';
import type { Vector } from './vectors.js';

export interface PickedPoint {
  /// In the input's coordinates.
  readonly point: Vector;
  /// The triangle's normal, by the order of its corners; of length 1, or (0, 0, 0) if it has no area.
  readonly normal: Vector;
  /// In the tiles' coordinates.
  readonly local: Vector;
  /// The level of the tile that it came from.
  readonly level: number;
  readonly index: number;
  /// It is a vertex of that tile.
  readonly isVertex: boolean;
  /// The tile is a partition: its triangles are the input's.
  readonly isOriginal: boolean;
  /// The vertex is one of the input, and these are its coordinates to the bit.
  readonly isExact: boolean;
  /// No more is it from the input's surface; Infinity: not known.
  readonly bound: number;
  /// The last decimal place of each coordinate that means something, as a power of ten: by the bound, or by the floats that are stored.
  readonly places: Vector;
  readonly globe: GlobePlace | null;
  /// Values at the point, in the order of the manifest: a label is that of the nearest vertex. Null: no value. `label`: its name, or ''.
  readonly values: readonly { readonly name: string; readonly value: number | null; readonly label: string }[];
}

function valuesOf({ between, atCorner }: Hit, attributes: readonly ScalarAttribute[], snaps: boolean): PickedPoint['values'] {
  return attributes.slice(0, atCorner.length).map((attribute, i) => {
    const { name } = attribute;
    const value = snaps || isLabel(attribute) ? atCorner[i] : between[i];
    return { name, value: value > LEAST_VALUE ? value : null, label: labelName(attribute, value) };
  });
}

/// Returns the place up to which a float is to be written so that it can be read back.
function floatPlace(value: number): number {
  const digits = [6, 7, 8].find((count) => Math.fround(Number(value.toPrecision(count))) === value) ?? 9;
  return magnitude(value) - digits + 1;
}

/// Vertices that are exact end where their floats do. Other points of a partition lie between three that do, and are as good as the largest coordinate.
function placesOf(point: Vector, local: Vector, bound: number, isExact: boolean): Vector {
  if (isExact) return point.map(floatPlace) as unknown as Vector;
  const step = 2 ** -23 * Math.max(...local.map(Math.abs), Number.MIN_VALUE);
  const place = bound > 0 && bound < Infinity ? Math.floor(Math.log10(bound)) : Math.ceil(Math.log10(step));
  return [place, place, place];
}

type Stored = Pick<Manifest, 'origin' | 'place' | 'up' | 'transform' | 'worstRounding' | 'partitions'> & { readonly source: Pick<Manifest['source'], 'doublePrecision'> & Partial<Pick<Manifest['source'], 'values'>> };

/// Returns how far storing coordinates may have moved a point of a partition.
function storedBound(local: Vector, { worstRounding, source, place }: Stored): number {
  const HALF_STEP = 2 ** -24; // of a float, in parts of it
  const largest = Math.max(...local.map((value, axis) => Math.abs(value + place[axis])));
  return worstRounding + (source.doublePrecision ? Math.sqrt(3) * HALF_STEP * largest : 0);
}

/// A point that somebody names: it counts as one of the original. In the input's coordinates.
export function placedPoint(point: Vector, manifest: Stored): PickedPoint {
  const coordinates = new Coordinates(manifest);
  const local = coordinates.fromInput(point);
  const level = Math.ceil(Math.log2(manifest.partitions));
  const bound = storedBound(local, manifest);
  return {
    point, local, level, normal: [0, 0, 0], index: -1, isVertex: false, isOriginal: true, isExact: false,
    bound, places: placesOf(point, local, bound, false), globe: coordinates.toGlobe(point), values: [],
  };
}

/// `snaps`: to the nearest corner of the triangle. `bound`: of the tile, where it is no partition.
export function pickedPoint(hit: Hit, manifest: Stored, snaps: boolean, bound = Infinity): PickedPoint {
  const coordinates = new Coordinates(manifest);
  const local = snaps ? hit.corner : hit.point;
  const point = coordinates.toInput(local);
  const isOriginal = hit.node.level === Math.ceil(Math.log2(manifest.partitions));
  const isExact = snaps && isOriginal && manifest.worstRounding === 0 && !manifest.source.doublePrecision;
  const off = isOriginal ? storedBound(local, manifest) : bound;
  return {
    point,
    normal: hit.normal,
    local,
    level: hit.node.level,
    index: hit.node.index,
    isVertex: snaps,
    isOriginal,
    isExact,
    bound: off,
    places: placesOf(point, local, off, isExact),
    globe: coordinates.toGlobe(point),
    values: valuesOf(hit, manifest.source.values ?? [], snaps),
  };
}
