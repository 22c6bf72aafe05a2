// SPDX-License-Identifier: MIT
// Tools share this: the view, its story, notes, settings, and the ways to points and lengths.
import { Places } from '../../src/tools/places.js';
import type { PointFinder } from '../../src/tools/point_finder.js';
import { Pointing } from '../../src/tools/pointing.js';
import { LengthScale, unitOfModel } from '../../src/tools/units.js';
import { writeDecimal } from '../numbers.js';
import type { PageStage } from '../view/page_stage.js';
import type { StoryHost } from '../view/story_host.js';
import { NotebookStore } from './notebook.js';
import type { ViewPart } from '../../src/view/view_table.js';
import { ToolLink } from './tool_link.js';
import { loadToolSettings, saveToolSettings, type ToolSettings } from './tool_settings.js';
import { words } from './words/words.js';

/// What links have of the parts of views that are tools'; '': nothing.
export type ToolLinks = Readonly<Partial<Record<ViewPart, string>>>;

export type WriteLink = (part: ViewPart, link: string) => void;

export class Workshop {
  private readonly own: Pointing;
  readonly places: Places;
  readonly settings: ToolSettings;
  readonly notebook: NotebookStore;
  private readonly links = new Map<ViewPart, ToolLink>();

  /// The view's manifest is there. `told`: what the address has; `write`: puts something else there, or takes it away.
  constructor(readonly bench: PageStage, readonly story: StoryHost, private told: ToolLinks, private readonly write: WriteLink) {
    this.own = new Pointing(bench);
    this.places = new Places(bench.view);
    this.settings = loadToolSettings(unitOfModel(this.places.manifest));
    this.notebook = new NotebookStore(this.link('notes'));
  }

  /// Finds points of all that is in the picture.
  get pointing(): PointFinder {
    return this.bench.points ?? this.own;
  }

  /// Tells lengths in the unit that was chosen.
  get scale(): LengthScale {
    return new LengthScale(this.settings.modelUnit, this.settings.shownUnit, words.units.unit, writeDecimal);
  }

  /// What links tell of a part, for the tool whose it is.
  link(part: ViewPart): ToolLink {
    const link = this.links.get(part) ?? new ToolLink(this.told[part] ?? '', (text) => { this.write(part, text); });
    this.links.set(part, link);
    return link;
  }

  /// Another link is followed.
  follow(told: ToolLinks): void {
    this.told = told;
    for (const [part, link] of this.links) link.follow(told[part] ?? '');
  }

  setSettings(change: Partial<ToolSettings>): void {
    Object.assign(this.settings, change);
    saveToolSettings(this.settings);
    this.bench.redraw();
  }
}
