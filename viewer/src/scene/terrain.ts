// SPDX-License-Identifier: MIT
// Tells whether a mesh is a terrain: seen from above, no part of it hides another one. Or one that lies on its side, as maps do whose file
// says that another axis points up.
import type { Tile } from '../hierarchy/tile.js';
import type { Vector } from '../cut/viewpoint.js';

export interface Terrain {
  /// The direction of heights, in the tiles' coordinates; of length 1.
  readonly along: Vector;
  /// Heights go up. Otherwise it is a sheet that is seen from its front.
  readonly upright: boolean;
  /// Along that direction, in the tiles' coordinates: what few vertices lie below and above of.
  readonly low: number;
  readonly high: number;
  /// Mean slope: rise over run.
  readonly slope: number;
}

/// Part of the surface that may look down: holes that were closed, a skirt.
const MOST_DOWN = 0.03;
/// A terrain's height is at most this part of its extent across.
const MOST_HEIGHT = 0.35;
/// The same of a sheet on its side: a thicker one is a relief, and light shows its form.
const MOST_THICKNESS = 0.03;
const FRONT: Vector = [0, 0, 1];
/// Vertices on each side that do not count: outliers would take all colours.
const OUTLIERS = 0.01;

function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function vertexOf({ positions }: Tile, vertex: number): Vector {
  return [positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]];
}

function minus(a: Vector, b: Vector): Vector {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

function cross(a: Vector, b: Vector): Vector {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/// Twice the area of the interior triangles that look up, and down, and of their shadows on the ground.
function areasOf(tile: Tile, up: Vector): { above: number; below: number; ground: number } {
  const areas = { above: 0, below: 0, ground: 0 };
  for (let corner = 0; corner < 3 * tile.interiorCount; corner += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => vertexOf(tile, tile.indices[corner + k]));
    const normal = cross(minus(b, a), minus(c, a));
    const shadow = dot(normal, up);
    areas[shadow > 0 ? 'above' : 'below'] += Math.hypot(...normal);
    areas.ground += Math.abs(shadow);
  }
  return areas;
}

/// Between the outliers, of all own vertices; `up`: along an axis, of length 1.
export function heightsOf(tile: Tile, up: Vector): readonly [number, number] {
  const heights = Float64Array.from({ length: tile.own }, (_, vertex) => dot(vertexOf(tile, vertex), up)).sort();
  const outside = Math.floor(OUTLIERS * heights.length);
  return heights.length === 0 ? [0, 0] : [heights[outside], heights[heights.length - 1 - outside]];
}

function extentAcross({ box }: Tile, up: Vector): number {
  return Math.max(...[0, 1, 2].map((axis) => (up[axis] === 0 ? box[axis + 3] - box[axis] : 0)));
}

function terrainAlong(root: Tile, along: Vector, most: number, upright: boolean): Terrain | null {
  const [low, high] = heightsOf(root, along);
  if (!(high > low && high - low < most * extentAcross(root, along))) return null;
  const { above, below, ground } = areasOf(root, along);
  if (Math.min(above, below) > MOST_DOWN * (above + below) || ground === 0) return null;
  return { along, upright, low, high, slope: Math.sqrt(Math.max(0, ((above + below) / ground) ** 2 - 1)) };
}

/// `root`: all of the mesh; `up`: along an axis. Which way its triangles are wound is of no matter. O(n log n).
export function terrainOf(root: Tile, up: Vector): Terrain | null {
  return terrainAlong(root, up, MOST_HEIGHT, true) ?? (up[2] === 0 ? terrainAlong(root, FRONT, MOST_THICKNESS, false) : null);
}
