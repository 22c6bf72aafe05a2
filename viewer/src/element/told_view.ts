// SPDX-License-Identifier: MIT
// How an element shows its model: as its view says, and of what that says nothing as the model is seen first.
import type { Manifest } from '../hierarchy/manifest.js';
import type { Pose } from '../scene/camera_pose.js';
import type { HierarchyView } from '../scene/hierarchy_view.js';
import { keyOf, type Lighting } from '../scene/lighting.js';
import { materialOf, rigOf, shownLook } from '../scene/shown_look.js';
import { poseOf } from '../view/pose.js';
import { overFirst, readLink } from '../view/view_link.js';
import { lookOf, standingOf } from '../view/view_look.js';
import { says, type View } from '../view/view_table.js';
import type { ShownParts } from './shown_parts.js';

export interface Shown {
  readonly view: HierarchyView;
  readonly lighting: Lighting;
  readonly signal: AbortSignal;
}

export class ToldView {
  private told = '';
  private known: Manifest | null = null;
  private parts: Promise<ShownParts | null> | null = null;

  /// `refuse`: code of it cannot be had.
  constructor(private readonly shown: Shown, private readonly refuse: (error: unknown) => void) {}

  /// As a link says, its model left out; '': as the model is seen first. False: it was so before, or the model has to come first.
  tell(told: string): boolean {
    if (told === this.told) return false;
    this.told = told;
    if (this.shown.view.manifest === null) return false;
    this.apply();
    return true;
  }

  /// The manifest may be another one, which says how the model is seen first. False: it is the same.
  greet(): boolean {
    const { manifest } = this.shown.view;
    if (manifest === this.known) return false;
    this.known = manifest;
    this.apply();
    return true;
  }

  /// What neither says stays as it is.
  apply(): void {
    const { view, lighting } = this.shown;
    const shown = this.view();
    const light = shown.light ?? { name: 'auto', key: null };
    if (says(shown, 'standing')) view.setStanding(standingOf(shown));
    const rig = rigOf(light.name, view);
    lighting.set(rig, light.key === null ? keyOf(rig) : { right: light.key[0], up: light.key[1] });
    const look = says(shown, 'look') ? lookOf(shown) : view.look;
    view.setLook({ ...shownLook(look, rig, view.standing.stretch, view), ...(says(shown, 'look') && { material: materialOf(light.name) }) });
    view.mostLevel = shown.level ?? view.mostLevel;
    this.applyParts(shown);
  }

  /// From there the model is seen if nobody says otherwise; null: all of it is in the picture.
  place(): Pose | null {
    const { view } = this.shown;
    const { camera } = readLink(this.told);
    const first = view.manifest?.view ?? {};
    const stands = JSON.stringify(standingOf(first)) === JSON.stringify(view.standing);
    const numbers = camera ?? (stands ? first.camera : undefined);
    return numbers === undefined ? null : poseOf(numbers);
  }

  private view(): View {
    return readLink(overFirst(this.told, this.shown.view.manifest?.view ?? {}));
  }

  /// Their code comes when they are first wanted.
  private applyParts(shown: View): void {
    const { view, signal } = this.shown;
    if (view.manifest === null || (this.parts === null && !says(shown, 'cut') && !says(shown, 'objects'))) return;
    this.parts ??= import('./shown_parts.js').then(({ ShownParts }) => (signal.aborted ? null : new ShownParts(view)));
    this.parts.then((parts) => parts?.show(this.view()), (error: unknown) => { this.refuse(error); });
  }
}
