// SPDX-License-Identifier: MIT
// The parts of a model's view share this, and tell each other by its events.
import { EventDispatcher } from 'three';
import { HierarchyView, type Manifest, type Stats, type ViewOptions } from '../../src/index.js';
import type { Spot } from '../address.js';
import type { Turn } from '../gallery/layout.js';
import type { Model } from '../listing.js';
import { element } from '../parts/element.js';
import type { Preferences, Theme } from '../preferences.js';
import type { Telling } from '../problems.js';
import type { Language } from '../words/languages.js';
import { words } from '../words/words.js';
import { Canvas } from './canvas.js';

/// The page gives these to a view.
export interface Surroundings extends Pick<ViewOptions, 'fetch' | 'createWorker'> {
  spot: Spot;
  /// As the gallery showed the model, to go on from there; null: it was not turned.
  turn: Turn | null;
  preferences: Preferences;
  /// Preferences have changed.
  chosen(): void;
  setTheme(theme: Theme): void;
  setLanguage(language: Language): void;
  /// To the gallery; null: there is none.
  leave: (() => void) | null;
  /// The address of what is told about the model, or itself; null: nothing is.
  findStory: (signal: AbortSignal) => Promise<string | null>;
  /// The camera stands still, elsewhere than before, or something else was chosen.
  rested(spot: Spot): void;
  /// What it returns takes the message away; one about the same subject takes its place.
  failed(message: string, telling?: Telling): () => void;
  /// Opens the model anew.
  again(): void;
}

export interface ContextEvents {
  /// A frame may be due.
  wake: object;
  /// The model can be drawn, or cannot be had.
  opened: object;
  refused: { error: unknown };
  /// Something else was chosen, or more is known of what was.
  chosen: object;
  /// Something of what links tell is another one, and the camera stands still.
  rested: object;
  /// From time to time while frames are drawn; `working`: something is on its way. `known`: from when on there is a manifest.
  report: { stats: Stats; working: boolean };
  known: { manifest: Manifest };
  /// The model has a story.
  story: { isTold: boolean };
}

const REST = 300; // milliseconds without movement

export class PageContext extends EventDispatcher<ContextEvents> {
  readonly canvas: Canvas;
  /// Holds everything of the view.
  readonly root = element('main', { class: 'view' });
  /// The picture is drawn on it, and it has the focus.
  readonly surface: HTMLElement;
  readonly ending = new AbortController();
  isOpened = false;
  /// Something is on the canvas.
  isShown = false;
  /// The next frame is drawn, whatever the view says.
  isDirty = true;
  private restTimer = 0;

  /// Throws Error where there is no WebGL 2.
  constructor(readonly model: Model, readonly around: Surroundings) {
    super();
    const { fetch, createWorker, preferences: { settings } } = around;
    this.canvas = new Canvas(() => new HierarchyView(model.url, { fetch, createWorker, settings, files: model.files }));
    const name = words.view.surface(model.name);
    this.surface = element('div', { class: 'surface', tabindex: '0', role: 'application', 'aria-label': name }, this.canvas.element);
    this.view.addEventListener('change', () => { this.dispatchEvent({ type: 'wake' }); });
  }

  get view(): HierarchyView {
    return this.canvas.view;
  }

  get signal(): AbortSignal {
    return this.ending.signal;
  }

  redraw(): void {
    this.isDirty = true;
    this.dispatchEvent({ type: 'wake' });
  }

  /// Links tell of the camera when it has come to rest.
  startRest(): void {
    window.clearTimeout(this.restTimer);
    this.restTimer = window.setTimeout(() => { this.rest(); }, REST);
  }

  rest(): void {
    window.clearTimeout(this.restTimer);
    this.dispatchEvent({ type: 'rested' });
  }

  /// Code could not be loaded.
  missCode(again: () => void): void {
    const retry = (): void => {
      done();
      again();
    };
    const done = this.around.failed(words.problems.noCode, { more: words.problems.noCodeMore, subject: 'tools', retry });
  }

  close(): void {
    this.ending.abort();
    window.clearTimeout(this.restTimer);
  }
}
