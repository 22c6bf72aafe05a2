// SPDX-License-Identifier: MIT
// Contour lines: where a surface passes through multiples of a height, each fifth of which is an index contour.
//
// Problem. Of a million triangles most meet no height, and some meet many.
// Idea. A triangle is looked at once: its lowest and highest corner tell the heights that it meets, and each of these has its own section.
// Invariant. What lies on a height counts as above it, in all triangles alike: lines end at borders of the mesh alone.
// Cost. O(triangles + segments); memory: the segments.
import type { DrawnTile } from '../scene/surface.js';
import { eachTriangle, SectionTracer, trianglesOf, type Polyline } from './section.js';
import { dot, type Vector } from './vectors.js';
import type { Triangles } from './volume.js';

/// Each fifth contour is drawn bolder, and labelled, as on maps.
export const INDEX_EVERY = 5;
/// More heights are no drawing.
export const MOST_HEIGHTS = 2000;

/// A point's height is `dot(up, point) + shift`.
export interface Heights {
  /// Has length 1.
  readonly up: Vector;
  readonly shift: number;
}

export interface Contour {
  readonly height: number;
  readonly isIndex: boolean;
  readonly lines: readonly Polyline[];
}

/// Returns a round interval, with about as many contours between two heights as are wanted.
export function roundInterval(rise: number, wanted = 20): number {
  if (!(rise > 0) || !Number.isFinite(rise)) return 1;
  const rough = rise / wanted;
  const power = 10 ** Math.floor(Math.log10(rough));
  return Number((([1, 2, 5].find((step) => step * power >= rough * (1 - 1e-9)) ?? 10) * power).toPrecision(1));
}

export class ContourTracer {
  private readonly tracers = new Map<number, SectionTracer>();

  /// Throws RangeError for an interval that is none.
  constructor(private readonly heights: Heights, private readonly interval: number) {
    if (!(interval > 0) || !Number.isFinite(interval)) throw new RangeError(`an interval of ${interval}`);
  }

  readonly addTriangle = (corners: readonly Vector[]): void => {
    const { heights: { up, shift }, interval } = this;
    const rises = corners.map((corner) => (dot(up, corner) + shift) / interval);
    const last = Math.floor(Math.max(...rises));
    for (let step = Math.ceil(Math.min(...rises)); step <= last; ++step) this.tracerOf(step).addTriangle(corners);
  };

  add(triangles: Triangles): void {
    eachTriangle(triangles, this.addTriangle);
  }

  /// From the lowest to the highest; none without lines.
  contours(): Contour[] {
    return [...this.tracers].sort(([a], [b]) => a - b).map(([step, tracer]) => ({
      height: this.heightOf(step), isIndex: step % INDEX_EVERY === 0, lines: tracer.join(),
    })).filter(({ lines }) => lines.length > 0);
  }

  /// Multiples of 0.1 are 0.3, and not 0.30000000000000004.
  private heightOf(step: number): number {
    return Number((step * this.interval).toPrecision(12));
  }

  private tracerOf(step: number): SectionTracer {
    const { heights: { up, shift }, tracers } = this;
    let tracer = tracers.get(step);
    if (tracer === undefined) {
      if (tracers.size >= MOST_HEIGHTS) throw new RangeError(`more than ${MOST_HEIGHTS} contours: choose a larger interval`);
      tracer = new SectionTracer({ normal: up, constant: shift - this.heightOf(step) });
      tracers.set(step, tracer);
    }
    return tracer;
  }
}

/// In the tiles' coordinates. Throws RangeError where the contours are too many.
export function contoursOf(surface: readonly DrawnTile[], heights: Heights, interval: number): Contour[] {
  const tracer = new ContourTracer(heights, interval);
  for (const drawn of surface) tracer.add(trianglesOf(drawn));
  return tracer.contours();
}
