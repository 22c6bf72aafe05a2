// SPDX-License-Identifier: MIT
// Rooms are looked into from outside: faces that look away from the camera are not drawn. On by itself where most of the hull looks away.
import { EventDispatcher } from 'three';
import type { Tile } from '../hierarchy/tile.js';
import type { HierarchyView, Plugin } from '../scene/hierarchy_view.js';
import { isInterior } from '../tools/interior.js';
import { attempt } from './attempt.js';

/// `auto`: as the model is.
export type DollhouseMode = 'auto' | 'on' | 'off';

/// Event `change`: it is on or off otherwise than before.
export class Dollhouse extends EventDispatcher<{ change: object }> implements Plugin {
  private view: HierarchyView | null = null;
  private chosen: DollhouseMode = 'auto';
  private judged: { readonly root: Tile; readonly isInterior: boolean } | null = null;

  constructor(readonly name = 'dollhouse') {
    super();
  }

  get mode(): DollhouseMode {
    return this.chosen;
  }

  set mode(mode: DollhouseMode) {
    this.chosen = mode;
    this.apply();
  }

  get isOn(): boolean {
    return this.view?.hidesBacks ?? false;
  }

  init(view: HierarchyView): void {
    this.view = view;
    this.apply();
  }

  /// The model may have come, or be another one.
  drawn(): void {
    if (this.chosen === 'auto' && this.judged?.root !== this.view?.root) this.apply();
  }

  dispose(): void {
    const { view } = this;
    this.view = this.judged = null;
    if (view !== null) view.hidesBacks = false;
  }

  private apply(): void {
    const { view } = this;
    const isOn = this.chosen === 'auto' ? this.judge() : this.chosen === 'on';
    if (view === null || view.hidesBacks === isOn) return;
    view.hidesBacks = isOn;
    this.dispatchEvent({ type: 'change' });
  }

  /// False as long as nothing is known.
  private judge(): boolean {
    const { view } = this;
    if (view === null || view.root === null) return false;
    const { root, upwards } = view;
    if (this.judged?.root !== root) this.judged = { root, isInterior: attempt(() => isInterior(root, upwards), () => false) };
    return this.judged.isInterior;
  }
}
