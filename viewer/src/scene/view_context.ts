// SPDX-License-Identifier: MIT
// The parts of a view share this: the choices, the tiles' scene, and the events.
import type { EventDispatcher } from 'three';
import { Account } from './account.js';
import { ModelForm } from './model_form.js';
import { lookOf, standingOf } from '../view/view_look.js';
import { says, type View } from '../view/view_table.js';
import { changedSettings, DEFAULT_LOOK, type Look, type Settings } from './settings.js';
import { changedStanding, DEFAULT_STANDING, type Standing } from './standing.js';
import type { Share } from './share.js';
import type { TileScene } from './tile_scene.js';
import type { ViewEvents, ViewOptions } from './view_options.js';

export class ViewContext {
  settings: Readonly<Settings>;
  look: Readonly<Look>;
  standing: Readonly<Standing>;
  /// The inside is in view, as of a model that is cut open.
  showsInside = false;
  /// No finer tiles are shown; null: all may be.
  mostLevel: number | null = null;
  /// Nobody has chosen how the model looks and stands: its manifest may.
  private isLookOpen: boolean;
  private isStandingOpen: boolean;
  /// Faces that look away from the camera are not drawn.
  hidesBacks = false;
  /// Null: all that the settings allow.
  share: Share | null = null;
  readonly form: ModelForm;
  readonly account = new Account();
  /// Aborts when the view is disposed of.
  readonly ending = new AbortController();
  private isDirty = false;
  private isAwake = false;

  constructor(
    readonly options: ViewOptions,
    readonly tiles: TileScene,
    readonly events: Pick<EventDispatcher<ViewEvents>, 'dispatchEvent'>,
  ) {
    this.settings = changedSettings(options.settings ?? {});
    this.look = { ...DEFAULT_LOOK, ...options.look };
    this.standing = changedStanding(options.standing ?? {}, DEFAULT_STANDING);
    this.isLookOpen = options.look === undefined;
    this.isStandingOpen = options.standing === undefined;
    this.form = new ModelForm(tiles);
  }

  /// Bytes of all tiles in memory, at the most.
  get mostBytes(): number {
    return this.share?.bytes ?? this.settings.memoryBudget;
  }

  choose(look: Partial<Look>): void {
    this.isLookOpen = false;
    this.look = { ...this.look, ...look };
  }

  stand(standing: Partial<Standing>): void {
    this.standing = changedStanding(standing, this.standing);
    this.isStandingOpen = false;
    this.form.stand(this.standing);
  }

  /// As the model is seen first; what was chosen already stays.
  takeFirst(view: View): void {
    if (this.isLookOpen && says(view, 'look')) this.look = lookOf(view);
    if (!this.isStandingOpen || !says(view, 'standing')) return;
    this.standing = standingOf(view);
    this.form.stand(this.standing);
  }

  /// The picture is another one.
  changed(): void {
    this.isDirty = true;
    this.wake();
  }

  /// It may be another one.
  wake(): void {
    this.isAwake = true;
    if (!this.ending.signal.aborted) this.events.dispatchEvent({ type: 'change' });
  }

  /// A frame was asked for since the last one.
  get wantsFrame(): boolean {
    return this.isAwake;
  }

  /// A frame begins. Returns whether its picture is another one.
  takeFrame(): boolean {
    const { isDirty } = this;
    this.isDirty = this.isAwake = false;
    return isDirty;
  }
}
