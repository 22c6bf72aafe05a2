// SPDX-License-Identifier: MIT
// Where a plane cuts what is drawn: segments of triangles, joined into polylines. Each edge of the mesh is cut in one point,
// the same for all triangles at it, so that lines meet exactly.
import type { DrawnTile } from '../scene/surface.js';
import type { Triangles } from './volume.js';
import { sideOf, type CutPlane } from './planes.js';
import { distanceOf, vertexAt, type Vector } from './vectors.js';

export interface Polyline {
  /// In the tiles' coordinates. The last is not the first again.
  readonly points: readonly Vector[];
  readonly isClosed: boolean;
}

/// One name for a place, whatever the signs of its zeros.
function nameOf([x, y, z]: Vector): string {
  return `${x + 0},${y + 0},${z + 0}`;
}

interface Cut {
  /// Names the edge.
  readonly name: string;
  readonly point: Vector;
}

/// The edge's ends in one order, whichever triangle asks.
function cutEdge(plane: CutPlane, a: Vector, b: Vector): Cut {
  const [nameA, nameB] = [nameOf(a), nameOf(b)];
  if (nameB < nameA) return cutEdge(plane, b, a);
  const [from, to] = [sideOf(plane, a), sideOf(plane, b)];
  const part = from / (from - to);
  return { name: `${nameA} ${nameB}`, point: [0, 1, 2].map((axis) => a[axis] + (b[axis] - a[axis]) * part) as unknown as Vector };
}

/// The ends of what a plane cuts out of a triangle; null: it lies on one side. What is on the plane counts as kept.
function cutTriangle(plane: CutPlane, corners: readonly Vector[]): readonly Cut[] | null {
  const kept = corners.map((corner) => sideOf(plane, corner) >= 0);
  const ends = [0, 1, 2].filter((k) => kept[k] !== kept[(k + 1) % 3]).map((k) => cutEdge(plane, corners[k], corners[(k + 1) % 3]));
  return ends.length === 2 ? ends : null;
}

/// Joins what a plane cuts out of triangles, which may come in any order.
export class SectionTracer {
  private readonly points = new Map<string, Vector>();
  private readonly next = new Map<string, Set<string>>();

  constructor(private readonly plane: CutPlane) {}

  /// A segment is there once, however often a mesh repeats a triangle.
  addTriangle(corners: readonly Vector[]): void {
    const cut = cutTriangle(this.plane, corners);
    if (cut !== null) this.add(cut);
  }

  private add([one, other]: readonly Cut[]): void {
    for (const { name, point } of [one, other]) {
      this.points.set(name, point);
      if (!this.next.has(name)) this.next.set(name, new Set());
    }
    this.next.get(one.name)!.add(other.name);
    this.next.get(other.name)!.add(one.name);
  }

  /// Lines with ends first: they begin where an odd number of segments meet.
  join(): Polyline[] {
    const lines: Polyline[] = [];
    for (const odd of [true, false])
      for (const [name, others] of this.next)
        while (others.size > 0 && (!odd || others.size % 2 === 1)) lines.push(this.walk(name));
    return lines.filter(({ points, isClosed }) => points.length > (isClosed ? 2 : 1));
  }

  private walk(start: string): Polyline {
    const names = [start];
    for (let at = start; ; ) {
      const to = this.take(at);
      if (to === null || to === start) return { points: this.distinct(names, to === start), isClosed: to === start };
      names.push(to);
      at = to;
    }
  }

  /// The other end of a segment that was not walked yet.
  private take(from: string): string | null {
    for (const to of this.next.get(from)!) {
      this.next.get(from)!.delete(to);
      this.next.get(to)!.delete(from);
      return to;
    }
    return null;
  }

  /// Edges that meet on the plane are cut at one place.
  private distinct(names: readonly string[], isClosed: boolean): Vector[] {
    const points = names.map((name) => this.points.get(name)!);
    return points.filter((point, i) => (i === 0 && !isClosed) || nameOf(point) !== nameOf(points[(i + points.length - 1) % points.length]));
  }
}

/// Calls `look` with the corners of each triangle.
export function eachTriangle({ positions, corners, count }: Triangles, look: (corners: readonly Vector[]) => void): void {
  for (let i = 0; i < 3 * count; i += 3) look([0, 1, 2].map((k) => vertexAt(positions, corners[i + k])));
}

/// The triangles of a tile as it is drawn.
export function trianglesOf({ tile: { positions, indices }, triangles }: DrawnTile): Triangles {
  return { positions, corners: indices, count: triangles };
}

/// A closed surface is cut in closed lines.
export function sectionOf(surface: readonly DrawnTile[], plane: CutPlane): Polyline[] {
  const tracer = new SectionTracer(plane);
  for (const drawn of surface) {
    const { sphere } = drawn;
    if (Math.abs(sideOf(plane, sphere.center.toArray())) > sphere.radius * (1 + 1e-6)) continue;
    eachTriangle(trianglesOf(drawn), (corners) => { tracer.addTriangle(corners); });
  }
  return tracer.join();
}

export function lengthOf({ points, isClosed }: Polyline): number {
  return points.reduce((sum, point, i) => sum + (i > 0 || isClosed ? distanceOf(point, points[(i + points.length - 1) % points.length]) : 0), 0);
}
