// SPDX-License-Identifier: MIT
// The parts of a view share this: the choices, the tiles' scene, and the events.
import type { EventDispatcher } from 'three';
import { Account } from './account.js';
import { ModelForm } from './model_form.js';
import { changedSettings, DEFAULT_LOOK, type Look, type Settings } from './settings.js';
import { changedStanding, DEFAULT_STANDING, type Standing } from './standing.js';
import type { TileScene } from './tile_scene.js';
import type { ViewEvents, ViewOptions } from './view_options.js';

export class ViewContext {
  settings: Readonly<Settings>;
  look: Readonly<Look>;
  standing: Readonly<Standing>;
  /// The inside is in view, as of a model that is cut open.
  showsInside = false;
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
    this.form = new ModelForm(tiles);
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
