// SPDX-License-Identifier: MIT
// The parts of a model's view share this, and tell each other by its events.
import { EventDispatcher } from 'three';
import { HierarchyView, type Manifest, type Stats, type ViewOptions } from '../../src/index.js';
import type { Spot } from '../address.js';
import type { Turn } from '../gallery/layout.js';
import type { Model } from '../listing.js';
import type { ModelEntry } from '../model_entry.js';
import type { Page } from '../page.js';
import { element } from '../parts/element.js';
import type { Poster } from '../poster.js';
import { words } from '../words/words.js';
import { Canvas } from './canvas.js';

/// How a visitor comes to a model.
export interface Arrival extends Pick<ViewOptions, 'fetch' | 'createWorker'> {
  readonly page: Page;
  /// The model, and where the address keeps what is seen of it.
  readonly entry: ModelEntry;
  readonly spot: Spot;
  /// The gallery showed the model so, to go on from there; null: it was not turned.
  readonly turn: Turn | null;
  /// False: there is nothing to go back to.
  readonly hasGallery: boolean;
  /// Stands in the model's place until it is drawn; null: nothing does.
  readonly poster: Poster | null;
  /// The address of what is told about the model, or itself; null: nothing is.
  readonly findStory: (signal: AbortSignal) => Promise<string | null>;
  /// Tells whether the visitor may say how the model is seen first, as far as the page can tell.
  readonly findPermission: (signal: AbortSignal) => Promise<boolean>;
  /// The server asks for a word before it keeps anything; known once the permission is.
  readonly asksToken: () => boolean;
  /// Another model to compare it with; null: none.
  readonly other: Model | null;
  /// Those of the listing.
  readonly findModels: (signal: AbortSignal) => Promise<readonly Model[]>;
}

export interface ContextEvents {
  /// A frame may be due.
  wake: object;
  /// The model can be drawn, or cannot be had.
  opened: object;
  /// The first picture of it is drawn.
  shown: object;
  refused: { error: unknown };
  /// Something else was chosen, or more is known of what was.
  chosen: object;
  /// Something of what links tell is another one, and the camera stands still.
  rested: object;
  /// From time to time while frames are drawn; `working`: something is on its way. `known`: from when on there is a manifest.
  report: { stats: Stats; working: boolean };
  /// The manifest has come, or another one.
  manifest: { manifest: Manifest };
  known: { manifest: Manifest };
  /// The model has a story.
  story: { isTold: boolean };
  /// L was pressed alone.
  lightKey: object;
}

const REST = 300; // milliseconds without movement

export class PageContext extends EventDispatcher<ContextEvents> {
  readonly page: Page;
  readonly model: Model;
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
  constructor(readonly arrival: Arrival) {
    super();
    const { fetch, createWorker, page, entry: { model } } = arrival;
    [this.page, this.model] = [page, model];
    this.canvas = new Canvas(() => new HierarchyView(model.url, { fetch, createWorker, settings: page.preferences.settings, files: model.files }));
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
    const done = this.page.problems.tell(words.problems.noCode, { more: words.problems.noCodeMore, subject: 'tools', retry });
  }

  close(): void {
    this.ending.abort();
    window.clearTimeout(this.restTimer);
  }
}
