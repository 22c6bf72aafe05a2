// SPDX-License-Identifier: MIT
// The tools of a view, loaded when they are first used, or when a link or a story tells of them.
import { linkOf, partsOf, readLink, writeLink } from '../../src/view/view_link.js';
import type { ViewPart } from '../../src/view/view_table.js';
import { Told } from '../story/told.js';
import type { Toolbox } from '../tools/toolbox.js';
import { TOOL_NAMES, TOOLS, type ToolName } from '../tools/tools.js';
import type { ToolLinks } from '../tools/workshop.js';
import type { PageStage } from './page_stage.js';
import type { StoryHost } from './story_host.js';

const TAPS = 'page object taps';

const PARTS = TOOL_NAMES.flatMap((name) => TOOLS[name].part ?? []);

/// What a link tells of each tool; `given`: of those that it says nothing of.
function linksOf(choices: string, given: ToolLinks = {}): ToolLinks {
  const said = partsOf(choices);
  return Object.fromEntries(PARTS.map((part) => [part, said.has(part) ? writeLink(readLink(linkOf(choices, part))) : (given[part] ?? '')]));
}

function isTold(part: ViewPart | null, links: ToolLinks): boolean {
  return part !== null && (links[part] ?? '') !== '';
}

/// Notes tell a story, and are not told by it.
function toldLinks(choices: string, given: ToolLinks): ToolLinks {
  return { ...linksOf(choices, given), notes: given.notes };
}

export class ToolHost {
  private tools: Toolbox | null = null;
  private linked = linksOf('');
  private readonly told = new Told(toldLinks);
  private news: readonly ToolName[] = []; // of a link

  constructor(private readonly stage: PageStage, private readonly story: StoryHost) {
    const { context } = stage;
    context.addEventListener('known', ({ manifest }) => {
      void this.showNews(true);
      if (manifest.objects !== null && stage.view.plugins.named(TAPS) === undefined) stage.view.registerPlugin({ name: TAPS, tapped: (right, up) => this.takes(right, up) });
    });
    context.addEventListener('story', ({ isTold }) => { if (!isTold) this.take(this.told.end(this.linked), false); });
  }

  /// As links have it: choices with & between; empty: there are none.
  get text(): string {
    return this.textOf(PARTS);
  }

  /// The same as a note of a story keeps it.
  get toldText(): string {
    return this.textOf(PARTS.filter((part) => part !== 'notes'));
  }

  /// What a link tells, instead of what was there before.
  follow(choices: string): void {
    this.take(linksOf(choices), true);
  }

  /// As a note of a story wants it, on top of what was there before the story.
  tell(choices: string): void {
    this.take(this.told.tell(choices, this.linked), false);
  }

  /// Null: the bar. Nothing happens before something is known of the model.
  async use(name: ToolName | null): Promise<void> {
    await this.withTools(async (tools) => tools.toggle(name), () => void this.use(name));
  }

  back(): boolean {
    return this.tools?.back() ?? false;
  }

  private textOf(parts: readonly ViewPart[]): string {
    return parts.map((part) => this.linked[part] ?? '').filter((text) => text !== '').join('&');
  }

  /// Nothing happens before something is known of the model. `again`: after the code did not come.
  private async withTools(use: (tools: Toolbox) => Promise<void>, again: () => void): Promise<void> {
    const { view, signal, context } = this.stage;
    if (view.manifest === null) return;
    try {
      const { Toolbox } = await import('../tools/toolbox.js');
      if (signal.aborted) return;
      if (this.tools === null) {
        const tools = new Toolbox(this.stage, this.story, this.linked, (part, link) => { this.setLink(part, link); });
        view.registerPlugin(tools);
        this.tools = tools;
      }
      await use(this.tools);
    } catch {
      context.missCode(again);
    }
  }

  /// `opens`: the card of a tool that comes now may open.
  private take(links: ToolLinks, opens: boolean): void {
    this.linked = links;
    this.news = TOOL_NAMES.filter((name) => isTold(TOOLS[name].part, links) && this.tools?.has(name) !== true);
    this.tools?.follow(links);
    void this.showNews(opens);
  }

  /// What a link tells of is shown once something is known of the model.
  private async showNews(opens: boolean): Promise<void> {
    const { news } = this;
    if (news.length === 0 || this.stage.view.manifest === null) return;
    this.news = [];
    const again = (): void => {
      this.news = news;
      void this.showNews(opens);
    };
    await this.withTools(async (tools) => tools.prepare(news, opens), again);
  }

  /// A tap where no tool is in use picks the object there.
  private takes(right: number, up: number): boolean {
    if (this.tools?.isWorking === true) return false;
    void this.use('objects').then(() => { this.tools?.tapped(right, up); });
    return true;
  }

  private setLink(part: ViewPart, link: string): void {
    this.linked = { ...this.linked, [part]: link };
    if (part === 'cut') this.stage.context.startRest(); // a slider tells very often
    else this.stage.context.rest();
  }
}
