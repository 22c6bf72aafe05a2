// SPDX-License-Identifier: MIT
// One storey of a house is looked at: what is above its ceiling is cut away, or all but it.
import { EventDispatcher } from 'three';
import type { HierarchyView, Plugin } from '../scene/hierarchy_view.js';
import type { Tile } from '../hierarchy/tile.js';
import { Coordinates } from '../tools/coordinates.js';
import type { CutPlane } from '../tools/planes.js';
import { storeysOf, type Storey } from '../tools/storeys.js';
import { dot, scale, type Vector } from '../tools/vectors.js';
import { Clipping } from './clipping.js';

/// Parts of a storey's height that the cut is below its ceiling, and at most below its floor.
const [BELOW_CEILING, BELOW_FLOOR] = [0.06, 0.05];
/// Part of a range that both cuts are lower than its ends.
const HAIR = 1e-3;

/// Heights along up, in the input's coordinates: all between them is drawn.
export type StoreyRange = readonly [from: number, to: number];

/// Event `change`: another part is drawn.
export class Storeys extends EventDispatcher<{ change: object }> implements Plugin {
  private view: HierarchyView | null = null;
  private readonly clipping: Clipping;
  private found: { readonly root: Tile; readonly up: string; readonly storeys: readonly Storey[] } | null = null;
  private chosen: StoreyRange | null = null;
  private cut = '';

  constructor(readonly name = 'storeys') {
    super();
    this.clipping = new Clipping(`${name} cut`);
  }

  init(view: HierarchyView): void {
    this.view = view;
    view.registerPlugin(this.clipping);
    this.apply();
  }

  /// The lowest first, in the input's coordinates; none: the model has no rooms, or is not known yet.
  get storeys(): readonly Storey[] {
    const { view } = this;
    if (view?.root == null || view.manifest === null) return [];
    const { root, upwards } = view;
    const up = upwards.join();
    const { shift } = this;
    if (this.found?.root !== root || this.found.up !== up)
      this.found = { root, up, storeys: storeysOf(root, upwards).map(({ floor, ceiling }) => ({ floor: floor + shift, ceiling: ceiling + shift })) };
    return this.found.storeys;
  }

  /// Null: all is drawn.
  get range(): StoreyRange | null {
    return this.chosen;
  }

  set range(range: StoreyRange | null) {
    if (range?.join() === this.chosen?.join()) return;
    this.chosen = range;
    this.apply();
    this.dispatchEvent({ type: 'change' });
  }

  /// Shows the storey of that number, from 0, with all below it, or alone; null: all.
  choose(number: number | null, isAlone = false): void {
    this.range = number === null ? null : this.rangeOf(number, isAlone);
  }

  /// The number of the storey that the range shows, and whether it does so alone; null: it shows all, or none of them.
  get shown(): { readonly number: number; readonly isAlone: boolean } | null {
    const { chosen, storeys } = this;
    if (chosen === null) return null;
    const [from, to] = chosen;
    const number = storeys.filter(({ floor }) => floor < to).length - 1;
    return number < 0 ? null : { number, isAlone: number > 0 ? from > storeys[number - 1].floor : from > this.rangeOf(0, false)[0] };
  }

  /// The model may have come, or stand on another axis.
  drawn(): void {
    if (this.chosen !== null && this.cutKey !== this.cut) this.apply();
  }

  dispose(): void {
    this.view?.unregisterPlugin(this.clipping);
    this.view = this.found = null;
    this.cut = '';
  }

  private rangeOf(number: number, isAlone: boolean): StoreyRange {
    const { storeys } = this;
    const { floor, ceiling } = storeys[number];
    const height = ceiling - floor;
    const under = number === 0 ? Infinity : (floor - storeys[number - 1].ceiling) / 2;
    return [isAlone ? floor - Math.min(BELOW_FLOOR * height, Math.max(under, 0)) : this.bottom - height, ceiling - BELOW_CEILING * height];
  }

  /// The least height of the model.
  private get bottom(): number {
    const { source: { min, max } } = this.view!.manifest!;
    return this.view!.upwards.reduce((sum, part, axis) => sum + Math.min(part * min[axis], part * max[axis]), 0);
  }

  /// From heights in the tiles' coordinates to those of the input.
  private get shift(): number {
    return dot(this.view!.upwards, new Coordinates(this.view!.manifest!).toInput([0, 0, 0]));
  }

  private get cutKey(): string {
    const { view } = this;
    return view?.manifest == null ? '' : JSON.stringify([this.chosen, view.upwards, this.shift]);
  }

  private apply(): void {
    const { view } = this;
    if (view?.manifest == null) return;
    this.cut = this.cutKey;
    this.clipping.cut(this.chosen === null ? [] : planesOf(view.upwards, this.chosen, this.shift));
  }
}

/// A floor at `from` is drawn whole, a ceiling at `to` not at all, however their heights are rounded.
function planesOf(up: Vector, [from, to]: StoreyRange, shift: number): CutPlane[] {
  const hair = HAIR * (to - from);
  return [{ normal: up, constant: shift - from + hair }, { normal: scale(up, -1), constant: to - hair - shift }];
}
