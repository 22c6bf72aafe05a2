// SPDX-License-Identifier: MIT
// Tools share this: the view, its story, notes, settings, and the ways to points and lengths.
import { Places } from '../../src/tools/places.js';
import { Pointing } from '../../src/tools/pointing.js';
import { LengthScale, unitOfModel } from '../../src/tools/units.js';
import type { PageStage } from '../view/page_stage.js';
import type { StoryHost } from '../view/story_host.js';
import { NotebookStore } from './notebook.js';
import { ObjectLinkStore } from './object_link_store.js';
import { loadToolSettings, saveToolSettings, type ToolSettings } from './tool_settings.js';
import { words } from './words/words.js';

/// What links have of the tools; null: nothing.
export interface ToolLinks {
  readonly notes: string | null;
  readonly objects: string | null;
}

export type WriteLink = (name: keyof ToolLinks, link: string | null) => void;

export class Workshop {
  readonly pointing: Pointing;
  readonly places: Places;
  readonly settings: ToolSettings;
  readonly notebook: NotebookStore;
  readonly objectLink: ObjectLinkStore;

  /// The view's manifest is there. `links`: what the address has; `write`: puts something else there, or takes it away.
  constructor(readonly bench: PageStage, readonly story: StoryHost, links: ToolLinks, write: WriteLink) {
    this.pointing = new Pointing(bench);
    this.places = new Places(bench.view);
    this.settings = loadToolSettings(unitOfModel(this.places.manifest));
    this.notebook = new NotebookStore(links.notes, (link) => { write('notes', link); });
    this.objectLink = new ObjectLinkStore(links.objects, (link) => { write('objects', link); });
  }

  /// Tells lengths in the unit that was chosen.
  get scale(): LengthScale {
    return new LengthScale(this.settings.modelUnit, this.settings.shownUnit, words.units.unit);
  }

  setSettings(change: Partial<ToolSettings>): void {
    Object.assign(this.settings, change);
    saveToolSettings(this.settings);
    this.bench.redraw();
  }
}
