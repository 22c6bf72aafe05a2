// SPDX-License-Identifier: MIT
// Points on the surface, and the lengths, angles and areas along them: of what is shown at once, then of the original.
import { EventDispatcher } from 'three';
import type { Plugin, Stage } from '../scene/hierarchy_view.js';
import { boundsOf, measuresOf, type Measures } from '../tools/measure.js';
import { placedPoint, type PickedPoint } from '../tools/picked_point.js';
import { Pointing } from '../tools/pointing.js';
import { LengthScale, unitOfModel } from '../tools/units.js';
import type { Vector } from '../tools/vectors.js';
import { Overlay, type Mark } from './overlay.js';
import { Whereabouts } from './whereabouts.js';

const MOST_POINTS = 500;

/// Tells a length that may be off by `bound`.
export type TellLength = (length: number, bound: number) => string;

export interface MeasuringOptions {
  /// False: points are not taken by tapping, nor marked over the picture; `choose` and `marks` are yours to call.
  isAlone?: boolean;
  /// Without it lengths are told in the model's unit.
  tell?: TellLength;
  /// Another one than `measuring`, where several measure.
  name?: string;
}

/// Event `change`: there are other points, or more is known of them. None are left once the model is another one that lies elsewhere.
export class Measuring extends EventDispatcher<{ change: object }> implements Plugin {
  readonly name: string;
  /// Points are those of vertices.
  snaps = false;
  private stage: Stage | null = null;
  private pointing: Pointing | null = null;
  private overlay: Overlay | null = null;
  private picked: readonly PickedPoint[] = [];
  private asking = new AbortController();
  private places = new Whereabouts();

  constructor(private readonly options: MeasuringOptions = {}) {
    super();
    this.name = options.name ?? 'measuring';
  }

  get points(): readonly PickedPoint[] {
    return this.picked;
  }

  enter(stage: Stage): void {
    this.stage = stage;
    this.pointing = new Pointing(stage);
    this.asking = new AbortController();
    this.places = new Whereabouts();
    if (this.options.isAlone === false) return;
    this.overlay = new Overlay();
    stage.root.append(this.overlay.root);
  }

  tapped(right: number, up: number): boolean {
    return this.overlay !== null && this.choose(right, up);
  }

  drawn(): void {
    if (this.stage === null) return;
    this.forgetOthers(this.stage);
    this.overlay?.show(this.marks(), this.stage.camera, this.stage.view.surfaceMatrix);
  }

  /// Takes the point at a place of the picture. False: nothing of the model is there, or there are too many.
  choose(right: number, up: number): boolean {
    if (this.stage !== null) this.forgetOthers(this.stage);
    const pointed = this.picked.length < MOST_POINTS ? ((this.stage?.points ?? this.pointing)?.at(right, up, this.snaps, this.asking.signal) ?? null) : null;
    if (pointed === null) return false;
    const { shown } = pointed;
    this.set([...this.picked, shown]);
    pointed.original.then((original) => {
      if (original) this.set(this.picked.map((point) => (point === shown ? original : point)));
    }, () => undefined);
    return true;
  }

  /// Takes these points instead, in the input's coordinates. Nothing happens before the view's manifest is there.
  place(points: readonly Vector[]): void {
    const manifest = this.stage?.view.manifest ?? null;
    if (manifest !== null) this.set(points.slice(0, MOST_POINTS).map((point) => placedPoint(point, manifest)));
  }

  /// Leaves so many of the points, the first ones.
  keep(count: number): void {
    this.set(this.picked.slice(0, count));
  }

  measures(): Measures {
    return measuresOf(this.picked.map(({ point }) => point), this.stage?.view.upwards ?? [0, 1, 0]);
  }

  /// They may be off by so much: less, as points of the original come.
  bounds(): Measures {
    return boundsOf(this.picked.map(({ point }) => point), this.picked.map(({ bound }) => bound));
  }

  marks(): readonly Mark[] {
    const [lengths, bounds, tell] = [this.measures().parts, this.bounds().parts, this.options.tell ?? this.inUnits()];
    const lines = this.picked.slice(1).map(({ local }, i) => ({ at: this.picked[i].local, to: local, text: tell(lengths[i], bounds[i]) }));
    return [...lines, ...this.picked.map(({ local }) => ({ at: local }))];
  }

  dispose(): void {
    this.asking.abort();
    this.overlay?.root.remove();
    this.stage = this.pointing = this.overlay = null;
    this.picked = [];
  }

  /// Points of a model that lay elsewhere.
  private forgetOthers({ view }: Stage): void {
    if (this.places.haveChanged(view.manifest) && this.picked.length > 0) this.keep(0);
  }

  private inUnits(): TellLength {
    const manifest = this.stage?.view.manifest ?? null;
    const unit = (manifest && unitOfModel(manifest)) ?? 'unit';
    const scale = new LengthScale(unit, unit);
    return (length, bound) => scale.formatWithin(length, bound);
  }

  private set(points: readonly PickedPoint[]): void {
    this.picked = points;
    this.dispatchEvent({ type: 'change' });
    this.stage?.redraw();
  }
}
