// SPDX-License-Identifier: MIT
// Problem: a scan of rooms shows its ceilings from above, and a statue is to keep its skin: which of the two is a mesh?
// Idea: rays from outside, down to level, through all of its box. Walls and ceilings that were seen from within turn their backs to them.
// Behind such backs lie floors, which are level; a statue whose triangles are wound the wrong way has none.
//
//      \  \   rays            ____________  ceiling, seen from its back
//       \  \                 |  \         |
//        v  v                |   v        |  the first front: a floor
//
// Invariant: the answer follows from the root tile and up alone. Cost: 600 rays in a tree of the root's triangles, about 30 ms.
import type { Tile } from '../hierarchy/tile.js';
import { RayProbe, type Ray } from './ray.js';
import { TriangleTree } from './triangle_tree.js';
import { add, cross, dot, scale, subtract, unit, vertexAt, type Vector } from './vectors.js';

export interface HullFacing {
  /// Rays that met the mesh, and those of them that met a back first.
  readonly met: number;
  readonly backs: number;
  /// Steep rays that met a front, and those of them whose first front is level and looks up.
  readonly fronts: number;
  readonly level: number;
}

const RAYS = 600;
const LEAST_MET = 60;
/// More of the hull than this looks away: of a sheet half of it does.
const MOST_BACKS = 0.6;
/// Within 30 degrees of level; a ball, inside out, has a quarter of its shadow so.
const LEVEL = 0.87;
const LEAST_LEVEL = 0.5;
const STEEP = 0.7;
/// Steps of an even sequence in five dimensions: powers of the root of x^6 = x + 1 (Roberts 2018).
const STEPS = [1, 2, 3, 4, 5].map((power) => 1.1347241384015194 ** -power);

type Mesh = Pick<Tile, 'positions' | 'indices' | 'interiorCount' | 'box'>;

/// Two directions across `up`, at right angles to each other.
function across(up: Vector): readonly [Vector, Vector] {
  const side = unit(cross(up, Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0]));
  return [side, cross(up, side)];
}

/// A ray from outside of a box through a place in it, downwards or level. `parts`: from 0 to 1: the place's, of the height and around.
function rayInto(box: readonly number[], up: Vector, parts: readonly number[]): Ray {
  const place = [0, 1, 2].map((axis) => box[axis] + parts[axis] * (box[axis + 3] - box[axis])) as unknown as Vector;
  const reach = Math.hypot(box[3] - box[0], box[4] - box[1], box[5] - box[2]);
  const [one, other] = across(up);
  const [rise, angle] = [parts[3], 2 * Math.PI * parts[4]];
  const level = Math.sqrt(1 - rise * rise);
  const direction = add(scale(up, -rise), add(scale(one, level * Math.cos(angle)), scale(other, level * Math.sin(angle))));
  return { from: subtract(place, scale(direction, reach)), direction };
}

/// Returns the normal of the first triangle that a ray meets; null: it meets none.
function firstNormal({ positions, indices }: Mesh, tree: TriangleTree, ray: Ray): Vector | null {
  const probe = new RayProbe(ray);
  let [limit, first] = [Infinity, -1];
  tree.visit(probe, limit, (triangle) => {
    const distance = probe.hits(positions, indices[3 * triangle], indices[3 * triangle + 1], indices[3 * triangle + 2]);
    if (distance < limit) [limit, first] = [distance, triangle];
    return limit;
  });
  if (first < 0) return null;
  const [a, b, c] = [0, 1, 2].map((k) => vertexAt(positions, indices[3 * first + k]));
  return unit(cross(subtract(b, a), subtract(c, a)));
}

/// Looks at a mesh from outside. `up`: of length 1.
export function hullFacing(mesh: Mesh, up: Vector): HullFacing {
  const tree = new TriangleTree(mesh.positions, mesh.indices, mesh.interiorCount);
  const facing = { met: 0, backs: 0, fronts: 0, level: 0 };
  for (let i = 1; i <= RAYS; ++i) {
    const ray = rayInto(mesh.box, up, STEPS.map((step) => (i * step) % 1));
    const normal = firstNormal(mesh, tree, ray);
    if (normal === null) continue;
    ++facing.met;
    if (dot(normal, ray.direction) > 0) ++facing.backs;
    if (dot(ray.direction, up) > -STEEP) continue;
    const front = firstNormal(mesh, tree, { ...ray, meetsFronts: true });
    if (front === null) continue;
    ++facing.fronts;
    if (dot(front, up) > LEVEL) ++facing.level;
  }
  return facing;
}

/// Tells whether a mesh was seen from within, as rooms are. One without a border is none of them: it is a body, at worst inside out.
export function isInterior(root: Mesh & Pick<Tile, 'closed'>, up: Vector): boolean {
  if (root.closed || root.interiorCount === 0) return false;
  const { met, backs, fronts, level } = hullFacing(root, up);
  return met >= LEAST_MET && backs > MOST_BACKS * met && level > LEAST_LEVEL * fronts;
}
