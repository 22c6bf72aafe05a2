// SPDX-License-Identifier: MIT
// Sections and contours of the original mesh. A partition is there at a time; of each what may cut it is kept, to be joined over all of them.
import type { TileRecord } from '../hierarchy/tile_index.js';
import type { TileSource } from '../scene/surface.js';
import { ContourTracer, type Contour, type Heights } from './contours.js';
import { lookAtOriginal, type OriginalOptions } from './original_triangles.js';
import { sideOf, type CutPlane } from './planes.js';
import { eachTriangle, SectionTracer, type Polyline } from './section.js';
import { dot, type Vector } from './vectors.js';
import type { Triangles } from './volume.js';

type Corners = readonly Vector[];

function sidesOf({ min, max }: TileRecord, plane: CutPlane): readonly [least: number, most: number] {
  const corner = (most: boolean): Vector => plane.normal.map((part, axis) => (part > 0 === most ? max[axis] : min[axis])) as unknown as Vector;
  return [sideOf(plane, corner(false)), sideOf(plane, corner(true))];
}

function chosen(parts: readonly Triangles[], isWanted: (corners: Corners) => boolean): Corners[] {
  const found: Corners[] = [];
  for (const part of parts) eachTriangle(part, (corners) => { if (isWanted(corners)) found.push(corners); });
  return found;
}

/// As sectionOf(), of the original. Rejects where a file cannot be had, and when the signal aborts.
export async function originalSection(source: TileSource, plane: CutPlane, options: OriginalOptions): Promise<Polyline[]> {
  const isMet = (record: TileRecord): boolean => {
    const [least, most] = sidesOf(record, plane);
    return least < 0 && most >= 0;
  };
  const isCut = (corners: Corners): boolean => new Set(corners.map((corner) => sideOf(plane, corner) >= 0)).size === 2;
  const tracer = new SectionTracer(plane);
  const found = await lookAtOriginal(source, isMet, (parts) => chosen(parts, isCut), options);
  for (const corners of found.flat()) tracer.addTriangle(corners);
  return tracer.join();
}

/// As contoursOf(), of the original. Rejects with RangeError where the contours are too many.
export async function originalContours(source: TileSource, heights: Heights, interval: number, options: OriginalOptions): Promise<Contour[]> {
  const tracer = new ContourTracer(heights, interval);
  const stepsOf = (corners: Corners): number[] => corners.map((corner) => (dot(heights.up, corner) + heights.shift) / interval);
  const isPassed = (corners: Corners): boolean => {
    const steps = stepsOf(corners);
    return Math.ceil(Math.min(...steps)) <= Math.floor(Math.max(...steps));
  };
  const found = await lookAtOriginal(source, () => true, (parts) => chosen(parts, isPassed), options);
  found.flat().forEach(tracer.addTriangle);
  return tracer.contours();
}
