// SPDX-License-Identifier: MIT
// The point of the drawn surface that a ray meets first.
import type { Matrix4 } from 'three';
import { Vector3 } from 'three';
import type { Node } from '../hierarchy/tree.js';
import { isParallel, type ViewCamera } from '../scene/projection.js';
import type { DrawnTile } from '../scene/surface.js';
import { RayProbe, type Ray, type TriangleProbe } from './ray.js';
import { ShownTrees } from './shown_trees.js';
import { valuesAt, type PickedTile } from './values_at.js';
import { add, cross, distanceOf, scale, subtract, unit, vertexAt, type Vector } from './vectors.js';

export interface Hit {
  readonly node: Node;
  /// In the tiles' coordinates.
  readonly point: Vector;
  /// The triangle's normal, of length 1; (0, 0, 0) if it has no area.
  readonly normal: Vector;
  /// The triangle's corner that is nearest to the point.
  readonly corner: Vector;
  /// From the ray's beginning, or the point that something near is looked for, in units of the model.
  readonly distance: number;
  /// All values of the tile's vertices, as the manifest lists them: between the corners, and of that nearest one.
  readonly between: readonly number[];
  readonly atCorner: readonly number[];
}

/// Tells whether a point may be hit: what is cut away may not. `values`: of a corner of its triangle.
export type Keeps = (point: Vector, values: readonly number[]) => boolean;

const KEEPS_ALL: Keeps = () => true;

/// From the near plane; parallel rays have no other beginning.
function parallelRay(camera: ViewCamera, right: number, up: number, toLocal: Readonly<Matrix4>): Ray {
  const { elements: e } = camera.projectionMatrix;
  const from = new Vector3((right - e[12]) / e[0], (up - e[13]) / e[5], -camera.near).applyMatrix4(camera.matrixWorld).applyMatrix4(toLocal);
  const direction = new Vector3(0, 0, -1).transformDirection(camera.matrixWorld).transformDirection(toLocal);
  return { from: from.toArray(), direction: direction.toArray() };
}

/// From the camera's eye through a place of the picture, from -1 to 1 to the right and up, in the coordinates that `matrix` brings into
/// the world. It meets nothing before the near plane: that is not drawn. Matrices are up to date.
export function rayThrough(camera: ViewCamera, right: number, up: number, matrix: Readonly<Matrix4>): Ray {
  const { elements: e } = camera.projectionMatrix;
  const toLocal = matrix.clone().invert();
  if (isParallel(camera)) return parallelRay(camera, right, up, toLocal);
  const eye = new Vector3().setFromMatrixPosition(camera.matrixWorld).applyMatrix4(toLocal);
  const ahead = new Vector3((right + e[8]) / e[0], (up + e[9]) / e[5], -1);
  const seen = ahead.clone().multiplyScalar(camera.near).applyMatrix4(camera.matrixWorld).applyMatrix4(toLocal);
  const direction = ahead.transformDirection(camera.matrixWorld).transformDirection(toLocal);
  return { from: eye.toArray(), direction: direction.toArray(), begin: seen.distanceTo(eye) };
}

/// The nearest of the triangles that are looked at.
export class Search {
  hit: Hit | null = null;
  limit = Infinity;

  constructor(
    readonly probe: TriangleProbe,
    private readonly keeps: Keeps = KEEPS_ALL,
  ) {}

  /// The corners a, b, c of a tile. Returns the limit.
  readonly look = (node: Node, tile: PickedTile, [a, b, c]: Vector): number => {
    const { positions } = tile;
    const distance = this.probe.hits(positions, a, b, c);
    if (!(distance < this.limit)) return this.limit;
    const corners = [a, b, c].map((vertex) => vertexAt(positions, vertex));
    const point = corners.map((corner, k) => scale(corner, this.probe.weights[k])).reduce(add);
    const values = [a, b, c].map((vertex) => valuesAt(tile, vertex));
    if (!this.keeps(point, values[0])) return this.limit;
    const normal = unit(cross(subtract(corners[1], corners[0]), subtract(corners[2], corners[0])));
    const nearest = [0, 1, 2].reduce((best, other) => (distanceOf(corners[other], point) < distanceOf(corners[best], point) ? other : best));
    const between = values[0].map((_, i) => values.reduce((sum, each, k) => sum + each[i] * this.probe.weights[k], 0));
    this.hit = { node, point, normal, corner: corners[nearest], distance, between, atCorner: values[nearest] };
    this.limit = distance;
    return this.limit;
  };
}

const ROUNDING = 1 + 1e-6; // of three's spheres

/// Picks on what is drawn.
export class Picker {
  private readonly trees: ShownTrees;

  /// `mostBytes`: of trees.
  constructor(mostBytes?: number) {
    this.trees = new ShownTrees(mostBytes);
  }

  get bytes(): number {
    return this.trees.bytes;
  }

  /// Null: the ray meets nothing.
  pick(surface: readonly DrawnTile[], ray: Ray, keeps: Keeps = KEEPS_ALL): Hit | null {
    return this.find(surface, new RayProbe(ray), keeps);
  }

  /// The nearest place that a probe finds; null: there is none.
  find(surface: readonly DrawnTile[], probe: TriangleProbe, keeps: Keeps = KEEPS_ALL): Hit | null {
    this.trees.forgetAllBut(surface);
    const search = new Search(probe, keeps);
    const entryOf = ({ sphere: { center, radius } }: DrawnTile): number => probe.entersSphere(center.toArray(), radius * ROUNDING);
    const met = surface.map((drawn) => ({ drawn, entry: entryOf(drawn) })).filter(({ entry }) => entry < Infinity);
    for (const { drawn, entry } of met.sort((a, b) => a.entry - b.entry)) if (entry < search.limit) this.searchTile(search, drawn);
    return search.hit;
  }

  /// Border triangles change with the cut: they are looked at one by one.
  private searchTile(search: Search, { node, tile, triangles }: DrawnTile): void {
    const { indices, interiorCount } = tile;
    const look = (triangle: number): number =>
      search.look(node, tile, [indices[3 * triangle], indices[3 * triangle + 1], indices[3 * triangle + 2]]);
    this.trees.of(tile).visit(search.probe, search.limit, look);
    for (let triangle = interiorCount; triangle < triangles; ++triangle) look(triangle);
  }
}
