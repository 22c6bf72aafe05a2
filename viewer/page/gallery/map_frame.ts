// SPDX-License-Identifier: MIT
// What a map shows of the globe, and which spots of it are drawn as one. Degrees on the globe, CSS pixels on the map.
//
// Idea: an upright grid of degrees, as wide as degrees are at the map's middle; no shores, no tiles of others. Spots that fall into one square of a grid
//   become one mark. The squares lie on the globe, not on the window, so that marks stay together while the map is moved.
import type { ModelSpot } from '../listing.js';

export interface Size {
  readonly width: number;
  readonly height: number;
}

export interface MapFrame {
  readonly longitude: number;
  readonly latitude: number;
  /// Pixels that a degree of latitude has.
  readonly scale: number;
}

export interface Cluster {
  /// Where its mark is, from the map's upper left corner.
  readonly x: number;
  readonly y: number;
  readonly spots: readonly ModelSpot[];
}

export const LEAST_SCALE = 0.5;
export const MOST_SCALE = 2e7; // a pixel is 5 mm
const MARGIN = 0.85; // of the map that all spots fill
const ALONE_SCALE = 40; // of spots at one place
const STEPS = [45, 30, 15, 10, 5, 2, 1];
const LEAST_LINES = 90; // pixels between two lines
const SQUARE = 48;
const MARK = 42; // as wide as a mark is drawn
const MOST_LINES = 60;

function shrink(latitude: number): number {
  return Math.max(Math.cos((latitude * Math.PI) / 180), 0.05);
}

function clamp(value: number, least: number, most: number): number {
  return Math.min(Math.max(value, least), most);
}

/// The frame that has all spots; the whole globe if there are none.
export function frameOf(spots: readonly ModelSpot[], { width, height }: Size): MapFrame {
  let [west, south, east, north] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [longitude, latitude] of spots) {
    [west, east] = [Math.min(west, longitude), Math.max(east, longitude)];
    [south, north] = [Math.min(south, latitude), Math.max(north, latitude)];
  }
  if (spots.length === 0) [west, south, east, north] = [-180, -90, 180, 90];
  const latitude = (south + north) / 2;
  const across = (width * MARGIN) / ((east - west) * shrink(latitude));
  const up = (height * MARGIN) / (north - south);
  const scale = Math.min(across, up);
  return { longitude: (west + east) / 2, latitude, scale: clamp(Number.isFinite(scale) ? scale : ALONE_SCALE, LEAST_SCALE, MOST_SCALE) };
}

export function toMap({ longitude, latitude, scale }: MapFrame, size: Size, [east, north]: readonly [number, number, ...unknown[]]): [number, number] {
  return [size.width / 2 + (east - longitude) * scale * shrink(latitude), size.height / 2 - (north - latitude) * scale];
}

/// Moves what is at a place of the map by pixels.
export function moved({ longitude, latitude, scale }: MapFrame, right: number, down: number): MapFrame {
  return { longitude: clamp(longitude - right / (scale * shrink(latitude)), -180, 180), latitude: clamp(latitude + down / scale, -90, 90), scale };
}

/// Enlarges the map about a place of it.
export function zoomed(frame: MapFrame, factor: number, size: Size, [x, y]: readonly [number, number]): MapFrame {
  const scale = clamp(frame.scale * factor, LEAST_SCALE, MOST_SCALE);
  const [right, down] = [x - size.width / 2, y - size.height / 2];
  const here = moved(frame, -right, -down);
  return moved({ ...here, scale }, right, down);
}

/// The spots that the map shows, and a little around it.
export function clustersOf(spots: readonly ModelSpot[], frame: MapFrame, size: Size): Cluster[] {
  const squares = new Map<string, ModelSpot[]>();
  const wide = frame.scale * shrink(frame.latitude);
  for (const spot of spots) {
    const [x, y] = toMap(frame, size, spot);
    if (x < -SQUARE || y < -SQUARE || x > size.width + SQUARE || y > size.height + SQUARE) continue;
    const key = `${Math.floor((spot[0] * wide) / SQUARE)} ${Math.floor((spot[1] * frame.scale) / SQUARE)}`;
    const square = squares.get(key);
    if (square === undefined) squares.set(key, [spot]);
    else square.push(spot);
  }
  return merged([...squares.values()].map((own) => clusterOf(own, frame, size)), frame, size);
}

function clusterOf(spots: readonly ModelSpot[], frame: MapFrame, size: Size): Cluster {
  const middle = [0, 1].map((axis) => spots.reduce((sum, spot) => sum + spot[axis], 0) / spots.length) as [number, number];
  const [x, y] = toMap(frame, size, middle);
  return { x, y, spots };
}

/// Large ones take in those that their marks would cover.
function merged(clusters: Cluster[], frame: MapFrame, size: Size): Cluster[] {
  const done: Cluster[] = [];
  for (const each of clusters.sort((a, b) => b.spots.length - a.spots.length)) {
    const near = done.findIndex(({ x, y }) => Math.hypot(x - each.x, y - each.y) < MARK);
    if (near < 0) done.push(each);
    else done[near] = clusterOf([...done[near].spots, ...each.spots], frame, size);
  }
  return done;
}

/// Degrees between two lines: a round number.
export function lineStep(scale: number): number {
  const least = LEAST_LINES / scale;
  if (least > 1) return [...STEPS].reverse().find((step) => step >= least) ?? STEPS[0];
  const power = 10 ** Math.floor(Math.log10(least));
  return Number(([1, 2, 5, 10].find((digit) => digit * power >= least * (1 - 1e-9))! * power).toPrecision(1));
}

/// The degrees at which lines are drawn, within a range.
export function linesWithin(least: number, most: number, step: number): number[] {
  const first = Math.ceil(least / step);
  const count = Math.min(Math.floor(most / step) - first + 1, MOST_LINES);
  return Array.from({ length: Math.max(count, 0) }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}
