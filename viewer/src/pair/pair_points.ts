// SPDX-License-Identifier: MIT
// Points of two models in one picture: of the one that is seen there, and how far the other one's surface is from it.
import { Vector3, type Matrix4 } from 'three';
import type { ViewCamera } from '../scene/projection.js';
import type { HierarchyView } from '../scene/hierarchy_view.js';
import { PointProbe } from '../tools/nearest.js';
import { findOriginal } from '../tools/original.js';
import { Picker, rayThrough, type Hit, type Keeps } from '../tools/pick.js';
import { pickedPoint, type PickedPoint } from '../tools/picked_point.js';
import type { Pointed, PointFinder } from '../tools/point_finder.js';
import { Pointing } from '../tools/pointing.js';
import { RayProbe, type TriangleProbe } from '../tools/ray.js';
import { recordedBound, shownBound } from '../tools/shown_bound.js';
import { add, dot, scale, subtract, type Vector } from '../tools/vectors.js';
import type { Both } from './budget.js';
import type { Pair, Side } from './pair.js';
import { tilesMatrix } from './placing.js';

/// The other model's surface, as seen from a point of the first.
export interface Across {
  /// From the point to the nearest place of the other surface; of two terrains upwards, below 0 where the other one is lower.
  readonly by: 'nearest' | 'height';
  /// In units of the first view; null: there is no surface of the other one above or below.
  readonly distance: number | null;
  /// It may be off by so much.
  readonly bound: number;
  /// The other model's values there.
  readonly values: PickedPoint['values'];
}

/// A point in the coordinates of the first view.
export interface PairedPoint extends PickedPoint {
  /// It lies on this model.
  readonly side: Side;
  /// Null: they are only laid on each other to be looked at, or the other one is not known yet.
  readonly across: Across | null;
}

function mapped(matrix: Matrix4, point: Vector): Vector {
  return new Vector3(...point).applyMatrix4(matrix).toArray();
}

/// `matrix`: of a point's coordinates, without shear.
function turned(matrix: Matrix4, direction: Vector): Vector {
  return direction.every((part) => part === 0) ? direction : new Vector3(...direction).transformDirection(matrix).toArray();
}

export class PairPoints implements PointFinder {
  private readonly pointings: Both<Pointing>;
  private readonly pickers: Both<Picker> = [new Picker(), new Picker()];

  constructor(private readonly pair: Pair, private readonly camera: ViewCamera, private readonly prepare: (side: Side | null) => void = () => undefined) {
    this.pointings = [new Pointing({ view: pair.first, camera }), new Pointing({ view: pair.second, camera })];
  }

  /// The model that is seen at a place of the picture; null: none is.
  sideAt(right: number, up: number): Side | null {
    const seen = this.pair.seenAt(right, up);
    const found = seen.sides.map((side) => ({ side, away: this.distanceAt(side, seen.right, seen.up) })).filter(({ away }) => away < Infinity);
    return found.length === 0 ? null : found.reduce((best, each) => (each.away < best.away ? each : best)).side;
  }

  at(right: number, up: number, snaps: boolean, signal: AbortSignal): Pointed | null {
    const seen = this.pair.seenAt(right, up);
    const side = this.sideAt(right, up);
    if (side === null) return null;
    this.prepare(seen.sides.length > 1 ? null : side);
    const pointed = this.pointings[side].at(seen.right, seen.up, snaps, signal);
    if (pointed === null) return null;
    const original = pointed.original.then(async (found) => found && this.paired(found, side, await this.acrossOriginal(found, side, signal)));
    original.catch(() => undefined); // whoever waits is told; nobody must
    return { shown: this.paired(pointed.shown, side, this.acrossShown(pointed.shown, side)), original };
  }

  private distanceAt(side: Side, right: number, up: number): number {
    const view = this.pair.views[side];
    const keeps: Keeps = (point, values) => view.plugins.keeps(new Vector3(...point).applyMatrix4(view.surfaceMatrix), values);
    const ray = { ...rayThrough(this.camera, right, up, view.surfaceMatrix), meetsFronts: view.hidesBacks };
    const hit = this.pickers[side].pick(view.surface, ray, keeps);
    if (hit === null) return Infinity;
    const [from, to] = [ray.from, hit.point].map((point) => new Vector3(...point).applyMatrix4(view.surfaceMatrix));
    return from.distanceTo(to); // their units may be others
  }

  /// From the tiles of the one side to those of the other.
  private toTiles(from: Side, to: Side): Matrix4 {
    const { first, second, laying } = this.pair;
    const matrix = tilesMatrix(first.manifest!, second.manifest!, laying!);
    if (from === to) return matrix.identity();
    return to === 0 ? matrix : matrix.invert();
  }

  private get factor(): number {
    const { first, second, laying } = this.pair;
    const e = tilesMatrix(first.manifest!, second.manifest!, laying!).elements;
    return Math.hypot(e[0], e[1], e[2]);
  }

  private paired(picked: PickedPoint, side: Side, across: Across | null): PairedPoint {
    if (side === 0) return { ...picked, side, across };
    const matrix = this.toTiles(1, 0);
    const isSame = this.pair.laying!.matrix.elements.every((value, i) => value === (i % 5 === 0 ? 1 : 0));
    const point = isSame ? picked.point : mapped(this.pair.laying!.matrix, picked.point);
    return { ...picked, side, across, point, local: mapped(matrix, picked.local), normal: turned(matrix, picked.normal), bound: picked.bound * this.factor };
  }

  private get isMeasured(): boolean {
    return this.pair.isReady && !this.pair.aligned;
  }

  private acrossShown(picked: PickedPoint, side: Side): Across | null {
    if (!this.isMeasured) return null;
    const other = (1 - side) as Side;
    const view = this.pair.views[other];
    const hit = this.pickers[other].find(view.surface, this.probeFor(picked, side));
    return this.across(picked, side, hit, hit === null ? 0 : shownBound(hit.node, view.surface, (node) => recordedBound(view.source, node)));
  }

  private async acrossOriginal(picked: PickedPoint, side: Side, signal: AbortSignal): Promise<Across | null> {
    const { source } = this.pair.views[1 - side];
    if (!this.isMeasured || source === null) return null;
    const hit = await findOriginal(source, this.probeFor(picked, side), { signal });
    return this.across(picked, side, hit, 0);
  }

  private get areTerrains(): boolean {
    return this.pair.views.every(({ terrain }) => terrain?.upright === true);
  }

  /// Looks for the point in the other view's tiles: between two terrains from above, else to all sides.
  private probeFor({ local }: PickedPoint, side: Side): TriangleProbe {
    const other = (1 - side) as Side;
    const view = this.pair.views[other];
    const point = mapped(this.toTiles(side, other), local);
    if (!this.areTerrains) return new PointProbe(point);
    const { upwards } = view;
    const reach = this.reachOf(view) + Math.abs(dot(point, upwards));
    return new RayProbe({ from: add(point, scale(upwards, reach)), direction: scale(upwards, -1) });
  }

  /// No point of its tiles is farther from their origin.
  private reachOf({ manifest }: HierarchyView): number {
    const { source: { min, max }, origin, place } = manifest!;
    return [0, 1, 2].reduce((sum, axis) => sum + Math.max(...[min, max].map((corner) => Math.abs(corner[axis] - origin[axis] - place[axis]))), 0);
  }

  private across(picked: PickedPoint, side: Side, hit: Hit | null, bound: number): Across {
    const other = (1 - side) as Side;
    const view = this.pair.views[other];
    const by = this.areTerrains ? 'height' : 'nearest';
    if (hit === null) return { by, distance: null, bound: 0, values: [] };
    const units = other === 1 ? this.factor : 1;
    const to = subtract(hit.point, mapped(this.toTiles(side, other), picked.local));
    const length = by === 'height' ? dot(to, view.upwards) : hit.distance;
    const found = pickedPoint(hit, view.manifest!, false, bound);
    return { by, distance: length * units, bound: picked.bound * (side === 1 ? this.factor : 1) + found.bound * units, values: found.values };
  }
}
