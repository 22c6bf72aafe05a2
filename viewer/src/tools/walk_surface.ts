// SPDX-License-Identifier: MIT
// What is drawn of a view, as the space that somebody walks in: a piece of it around the feet, made anew when they leave its middle or when
// other tiles are drawn.
import { Box3, Vector3, type Matrix4, type Plane } from 'three';
import type { Tile } from '../hierarchy/tile.js';
import type { Omits } from '../scene/omission.js';
import type { DrawnTile } from '../scene/surface.js';
import { ShownTrees } from './shown_trees.js';
import { WalkSpace, type Plan } from './walk_space.js';

/// A view is asked for this.
export interface WalkedView {
  readonly surface: readonly DrawnTile[];
  readonly surfaceMatrix: Readonly<Matrix4>;
  readonly omits: Omits | null;
  readonly plugins: { readonly cuts: readonly Plane[] };
}

const REACH = 1.5; // eye heights around the feet
const INNER = 0.7; // from which it is made anew

/// Gathers triangles that touch a box of the world, as nine numbers each.
class Gathering {
  readonly numbers: number[] = [];
  private readonly corners = [new Vector3(), new Vector3(), new Vector3()];
  private readonly middle = new Vector3();
  private readonly local: readonly number[];

  constructor(private readonly view: WalkedView, private readonly box: Box3) {
    const { min, max } = box.clone().applyMatrix4(view.surfaceMatrix.clone().invert());
    this.local = [...min.toArray(), ...max.toArray()];
  }

  add({ tile, triangles, sphere }: DrawnTile, trees: ShownTrees): void {
    const [a, b, c, d, e, f] = this.local;
    if (!new Box3(new Vector3(a, b, c), new Vector3(d, e, f)).intersectsSphere(sphere)) return;
    trees.of(tile).visitBox(this.local, (triangle) => { this.addTriangle(tile, triangle); });
    for (let triangle = tile.interiorCount; triangle < triangles; ++triangle) this.addTriangle(tile, triangle);
  }

  private addTriangle(tile: Tile, triangle: number): void {
    const { view, corners, middle } = this;
    if (view.omits?.(tile, tile.indices[3 * triangle]) === true) return;
    middle.set(0, 0, 0);
    corners.forEach((corner, k) => {
      corner.fromArray(tile.positions, 3 * tile.indices[3 * triangle + k]).applyMatrix4(view.surfaceMatrix);
      middle.addScaledVector(corner, 1 / 3);
    });
    const touches = [0, 1, 2].every((axis) => {
      const all = corners.map((corner) => corner.getComponent(axis));
      return Math.min(...all) <= this.box.max.getComponent(axis) && Math.max(...all) >= this.box.min.getComponent(axis);
    });
    if (!touches || view.plugins.cuts.some((plane) => plane.distanceToPoint(middle) < 0)) return;
    for (const { x, y, z } of corners) this.numbers.push(x, y, z);
  }
}

export class WalkSurface {
  private readonly trees = new ShownTrees();
  private known: { readonly space: WalkSpace; readonly at: Vector3; readonly reach: number } | null = null;
  private drawn: readonly unknown[] = [];

  constructor(private readonly view: WalkedView, private readonly bottom: () => number) {}

  /// Since last asked.
  haveTilesChanged(): boolean {
    const { surface, surfaceMatrix, plugins } = this.view;
    const now = [...surface.flatMap(({ tile, triangles }) => [tile, triangles]), ...surfaceMatrix.elements, ...plugins.cuts.flatMap(({ normal, constant }) => [...normal, constant])];
    const isSame = now.length === this.drawn.length && now.every((each, i) => each === this.drawn[i]);
    if (!isSame) [this.drawn, this.known] = [now, null];
    return !isSame;
  }

  /// The space around feet of a walker of that eye height.
  around({ x, z, y }: Plan & { readonly y: number }, eyeHeight: number): WalkSpace {
    const { known } = this;
    const at = new Vector3(x, y, z);
    const inner = INNER * eyeHeight;
    if (known !== null && known.reach === eyeHeight && Math.max(Math.abs(known.at.x - x), Math.abs(known.at.z - z), Math.abs(known.at.y - y)) < inner) return known.space;
    const reach = REACH * eyeHeight;
    const box = new Box3(new Vector3(x - reach, Math.min(this.bottom(), y) - eyeHeight, z - reach), new Vector3(x + reach, y + 2 * reach, z + reach));
    const gathering = new Gathering(this.view, box);
    this.trees.forgetAllBut(this.view.surface);
    for (const each of this.view.surface) gathering.add(each, this.trees);
    this.known = { space: new WalkSpace(Float64Array.from(gathering.numbers)), at, reach: eyeHeight };
    return this.known.space;
  }
}
