// SPDX-License-Identifier: MIT
// The volume that a closed surface encloses, or that lies between an open one and a plane, as far as planes keep it. By Gauss's
// theorem: of a field that grows along a plane's normal from 0 on, all of it is in the flux through the surface, none through the cut.
import type { Indices } from '../hierarchy/copies.js';
import type { Node } from '../hierarchy/tree.js';
import type { DrawnTile } from '../scene/surface.js';
import { flipped, sideOf, type CutPlane } from './planes.js';
import { cross, dot, subtract, vertexAt, type Vector } from './vectors.js';

export interface Volume {
  /// Negative: the surface's front is inside.
  readonly volume: number;
  /// How much it changes, at the most, where the surface moves by as much as it may be off; Infinity: that is not known.
  readonly bound: number;
}

/// The prism above what a plane keeps: how high it is there, where it ends, and its sides.
interface Region {
  readonly base: CutPlane;
  readonly height: number;
  readonly sides: readonly CutPlane[];
}

/// `planes`: one, or the six of a box, in the order of boxPlanes().
function regionOf([base, top, ...sides]: readonly CutPlane[]): Region {
  return { base, height: top === undefined ? Infinity : base.constant + top.constant, sides };
}

/// Tells whether a plane cuts away all of a tile, or nothing of it.
function isBelow(plane: CutPlane, { sphere }: DrawnTile, reach: number): boolean {
  return sideOf(plane, sphere.center.toArray()) < -sphere.radius * (1 + 1e-6) - reach;
}

/// Returns the part of a flat, convex polygon that a plane keeps.
function clipped(polygon: readonly Vector[], plane: CutPlane): readonly Vector[] {
  const sides = polygon.map((point) => sideOf(plane, point));
  if (sides.every((side) => side >= 0)) return polygon;
  return polygon.flatMap((point, i) => {
    const next = (i + 1) % polygon.length;
    const crosses = sides[i] >= 0 !== sides[next] >= 0;
    const part = sides[i] / (sides[i] - sides[next]);
    const cut = (): Vector => [0, 1, 2].map((axis) => point[axis] + part * (polygon[next][axis] - point[axis])) as unknown as Vector;
    return [...(sides[i] >= 0 ? [point] : []), ...(crosses ? [cut()] : [])];
  });
}

/// The integral of what `heightOf` is over the polygon's shadow on a plane: exact, as it is linear on it.
function fluxThrough(polygon: readonly Vector[], normal: Vector, heightOf: (point: Vector) => number): number {
  const [first] = polygon;
  let flux = 0;
  for (let i = 2; i < polygon.length; ++i) {
    const [a, b] = [polygon[i - 1], polygon[i]];
    const shadow = dot(cross(subtract(a, first), subtract(b, first)), normal) / 2;
    flux += (shadow * (heightOf(first) + heightOf(a) + heightOf(b))) / 3;
  }
  return flux;
}

function fluxOf(triangle: readonly Vector[], { base, height, sides }: Region): number {
  const within = sides.reduce(clipped, clipped(triangle, base));
  if (within.length < 3) return 0;
  const above = (point: Vector): number => sideOf(base, point);
  if (within.every((point) => above(point) <= height)) return fluxThrough(within, base.normal, above);
  const top = { normal: base.normal, constant: base.constant - height };
  return fluxThrough(clipped(within, flipped(top)), base.normal, above) + fluxThrough(clipped(within, top), base.normal, () => height);
}

/// The part of a triangle in what lies within `reach` of a surface on one of its sides; all of them are no less than that: of the points whose
/// nearest one is within the triangle a slab, of those nearest to an edge, which has two triangles, half of half a cylinder, and to a vertex, which
/// has three and more, a third of half a ball, three times.
function beside(area: number, edges: number, reach: number): number {
  return reach * (area + reach * ((Math.PI / 4) * edges + ((2 * Math.PI) / 3) * reach));
}

/// How far a vertex is above a plane.
function heightAt({ normal, constant }: CutPlane, positions: ArrayLike<number>, vertex: number): number {
  return normal[0] * positions[3 * vertex] + normal[1] * positions[3 * vertex + 1] + normal[2] * positions[3 * vertex + 2] + constant;
}

function isFar(positions: ArrayLike<number>, corners: readonly number[], planes: readonly CutPlane[], reach: number): boolean {
  return planes.some((plane) => corners.every((corner) => heightAt(plane, positions, corner) < -reach));
}

function lengthBetween(positions: ArrayLike<number>, a: number, b: number): number {
  const x = positions[3 * a] - positions[3 * b];
  const y = positions[3 * a + 1] - positions[3 * b + 1];
  const z = positions[3 * a + 2] - positions[3 * b + 2];
  return Math.sqrt(x * x + y * y + z * z);
}

/// Triangles, three corners each, of `positions`.
export interface Triangles {
  readonly positions: Float32Array;
  readonly corners: Indices;
  readonly count: number;
}

/// The part of some of a surface's triangles, which may be off by `reach`. Those that no plane cuts, most of them, are summed without making anything.
export function partOfVolume({ positions, corners, count }: Triangles, planes: readonly CutPlane[], reach: number): Volume {
  const region = regionOf(planes);
  const { base, height, sides } = region;
  const [nx, ny, nz] = base.normal;
  let volume = 0;
  let bound = 0;
  for (let i = 0; i < 3 * count; i += 3) {
    const a = corners[i];
    const b = corners[i + 1];
    const c = corners[i + 2];
    const aboveA = heightAt(base, positions, a);
    const aboveB = heightAt(base, positions, b);
    const aboveC = heightAt(base, positions, c);
    if (Math.max(aboveA, aboveB, aboveC) < -reach) continue;
    const ux = positions[3 * b] - positions[3 * a];
    const uy = positions[3 * b + 1] - positions[3 * a + 1];
    const uz = positions[3 * b + 2] - positions[3 * a + 2];
    const vx = positions[3 * c] - positions[3 * a];
    const vy = positions[3 * c + 1] - positions[3 * a + 1];
    const vz = positions[3 * c + 2] - positions[3 * a + 2];
    const x = uy * vz - uz * vy;
    const y = uz * vx - ux * vz;
    const z = ux * vy - uy * vx;
    const isWhole = Math.min(aboveA, aboveB, aboveC) >= 0 && Math.max(aboveA, aboveB, aboveC) <= height && sides.every((side) => heightAt(side, positions, a) >= 0 && heightAt(side, positions, b) >= 0 && heightAt(side, positions, c) >= 0);
    if (isWhole) volume += ((x * nx + y * ny + z * nz) * (aboveA + aboveB + aboveC)) / 6;
    else volume += fluxOf([a, b, c].map((vertex) => vertexAt(positions, vertex)), region);
    if (reach === 0 || (!isWhole && isFar(positions, [a, b, c], planes, reach))) continue;
    bound += beside(Math.sqrt(x * x + y * y + z * z) / 2, lengthBetween(positions, a, b) + lengthBetween(positions, b, c) + lengthBetween(positions, c, a), reach);
  }
  return { volume, bound };
}

export function sumOf(volumes: readonly Volume[]): Volume {
  return volumes.reduce((sum, { volume, bound }) => ({ volume: sum.volume + volume, bound: sum.bound + bound }), { volume: 0, bound: 0 });
}

/// The planes of volumeOf() that cut all away that lies behind them. What lies beyond a box's top is the prism's too.
export function cutsOf(planes: readonly CutPlane[]): readonly CutPlane[] {
  return planes.filter((_, i) => i !== 1);
}

/// Measures what is drawn, in the tiles' coordinates. A volume that grows on one side of the surface and shrinks on the other changes by no more than one of the
/// two. `planes`: one, or the six of a box as boxPlanes() has them. `boundOf`: how far a drawn tile may be off. O(drawn triangles).
export function volumeOf(surface: readonly DrawnTile[], planes: readonly CutPlane[], boundOf: (node: Node) => number): Volume {
  const cuts = cutsOf(planes);
  return sumOf(surface.map((drawn) => {
    const { node, tile: { positions, indices }, triangles } = drawn;
    const reach = boundOf(node);
    const isAway = cuts.some((plane) => isBelow(plane, drawn, reach));
    return isAway ? { volume: 0, bound: 0 } : partOfVolume({ positions, corners: indices, count: triangles }, planes, reach);
  }));
}
