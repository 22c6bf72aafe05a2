// SPDX-License-Identifier: MIT
// Tools share this: the view, its story, notes, settings, and the ways to points and lengths.
import { Places } from '../../src/tools/places.js';
import { Pointing } from '../../src/tools/pointing.js';
import { LengthScale, unitOfModel } from '../../src/tools/units.js';
import type { PageStage } from '../view/page_stage.js';
import type { StoryHost } from '../view/story_host.js';
import { NotebookStore } from './notebook.js';
import { loadToolSettings, saveToolSettings, type ToolSettings } from './tool_settings.js';
import { words } from './words/words.js';

export class Workshop {
  readonly pointing: Pointing;
  readonly places: Places;
  readonly settings: ToolSettings;
  readonly notebook: NotebookStore;

  /// The view's manifest is there. `link`: the notes that the address has; `write`: puts others there, or takes them away.
  constructor(readonly bench: PageStage, readonly story: StoryHost, link: string | null, write: (link: string | null) => void) {
    this.pointing = new Pointing(bench);
    this.places = new Places(bench.view);
    this.settings = loadToolSettings(unitOfModel(this.places.manifest));
    this.notebook = new NotebookStore(link, write);
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
