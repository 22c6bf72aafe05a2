// SPDX-License-Identifier: MIT
// The tools of a view, loaded when they are first used, and what its links tell of them.
import { choiceOf, type Spot } from '../address.js';
import type { Toolbox } from '../tools/toolbox.js';
import { objectsOfChoices } from '../tools/object_link.js';
import type { ToolName } from '../tools/tools.js';
import type { ToolLinks } from '../tools/workshop.js';
import type { PageStage } from './page_stage.js';
import type { StoryHost } from './story_host.js';

const TAPS = 'page object taps';

export class ToolHost {
  private tools: Toolbox | null = null;
  private linked: ToolLinks = { notes: null, objects: null };
  private news: readonly ToolName[] = []; // of a link

  constructor(private readonly stage: PageStage, private readonly story: StoryHost) {
    stage.context.addEventListener('known', ({ manifest }) => {
      void this.showNews();
      if (manifest.objects !== null && stage.view.plugins.named(TAPS) === undefined) stage.view.registerPlugin({ name: TAPS, tapped: (right, up) => this.takes(right, up) });
    });
  }

  /// As links have it: choices with & between; empty: there are none.
  get links(): string {
    const { notes, objects } = this.linked;
    return [notes === null ? null : `notes=${notes}`, objects].filter((part) => part !== null).join('&');
  }

  /// What a link tells, instead of what was there before.
  follow(spot: Spot): void {
    this.linked = { notes: choiceOf(spot, 'notes'), objects: objectsOfChoices(spot.choices) };
    this.news = (['objects', 'notes'] as const).filter((name) => this.linked[name] !== null && this.tools?.has(name) !== true);
    this.tools?.follow(this.linked);
    if (this.tools !== null) void this.showNews();
  }

  /// Null: the bar. Nothing happens before something is known of the model.
  async use(name: ToolName | null): Promise<void> {
    const { view, signal, context } = this.stage;
    if (view.manifest === null) return;
    try {
      const { Toolbox } = await import('../tools/toolbox.js');
      if (signal.aborted) return;
      if (this.tools === null) {
        const tools = new Toolbox(this.stage, this.story, this.linked, (which, link) => { this.setLink(which, link); });
        view.registerPlugin(tools);
        this.tools = tools;
      }
      await this.tools.toggle(name);
    } catch {
      context.missCode(() => void this.use(name));
    }
  }

  back(): boolean {
    return this.tools?.back() ?? false;
  }

  /// What a link tells of is shown once something is known of the model.
  private async showNews(): Promise<void> {
    const { news } = this;
    this.news = [];
    for (const name of news) await this.use(name);
  }

  /// A tap where no tool is in use picks the object there.
  private takes(right: number, up: number): boolean {
    if (this.tools?.isWorking === true) return false;
    void this.use('objects').then(() => { this.tools?.tapped(right, up); });
    return true;
  }

  private setLink(which: keyof ToolLinks, link: string | null): void {
    this.linked = { ...this.linked, [which]: link };
    this.stage.context.rest();
  }
}
