// SPDX-License-Identifier: MIT
// The volume that a closed surface encloses, or that lies between an open one and a plane, as far as planes keep it. By Gauss's
// theorem: of a field that grows along a plane's normal from 0 on, all of it is in the flux through the surface, none through the cut.
import type { Indices } from '../hierarchy/tile.js';
import type { Node } from '../hierarchy/tree.js';
import type { DrawnTile } from '../scene/surface.js';
import { sideOf, type CutPlane } from './planes.js';
import { cross, distanceOf, dot, length, subtract, vertexAt, type Vector } from './vectors.js';

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

/// What a plane cuts away of all of a tile, or of nothing of it.
function isBelow(plane: CutPlane, { sphere }: DrawnTile, reach: number): boolean {
  return sideOf(plane, sphere.center.toArray()) < -sphere.radius * (1 + 1e-6) - reach;
}

/// What of a flat, convex polygon a plane keeps.
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
  const below = { normal: [-top.normal[0], -top.normal[1], -top.normal[2]] as const, constant: -top.constant };
  return fluxThrough(clipped(within, below), base.normal, above) + fluxThrough(clipped(within, top), base.normal, () => height);
}

/// The part of a triangle in what lies within `reach` of a surface on one of its sides; all of them are no less than that: of the points whose
/// nearest one is within the triangle a slab, of those nearest to an edge, which has two triangles, half of half a cylinder, and to a vertex, which
/// has three and more, a third of half a ball, three times.
function beside([a, b, c]: readonly Vector[], reach: number): number {
  const area = length(cross(subtract(b, a), subtract(c, a))) / 2;
  const edges = distanceOf(a, b) + distanceOf(b, c) + distanceOf(c, a);
  return reach * (area + reach * ((Math.PI / 4) * edges + ((2 * Math.PI) / 3) * reach));
}

function isFar(triangle: readonly Vector[], planes: readonly CutPlane[], reach: number): boolean {
  return planes.some((plane) => triangle.every((point) => sideOf(plane, point) < -reach));
}

/// Triangles, three corners each, of `positions`.
export interface Triangles {
  readonly positions: Float32Array;
  readonly corners: Indices;
  readonly count: number;
}

/// The part of some of a surface's triangles, which may be off by `reach`.
export function partOfVolume({ positions, corners, count }: Triangles, planes: readonly CutPlane[], reach: number): Volume {
  const region = regionOf(planes);
  let [volume, bound] = [0, 0];
  for (let i = 0; i < 3 * count; i += 3) {
    const triangle = [vertexAt(positions, corners[i]), vertexAt(positions, corners[i + 1]), vertexAt(positions, corners[i + 2])];
    volume += fluxOf(triangle, region);
    if (reach > 0 && !isFar(triangle, planes, reach)) bound += beside(triangle, reach);
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

/// Of what is drawn, in the tiles' coordinates. A volume that grows on one side of the surface and shrinks on the other changes by no more than one of the
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
