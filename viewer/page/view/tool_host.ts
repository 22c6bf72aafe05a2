// SPDX-License-Identifier: MIT
// The tools of a view, loaded when they are first used, and the notes that its links have.
import { choiceOf, type Spot } from '../address.js';
import type { Toolbox } from '../tools/toolbox.js';
import type { ToolName } from '../tools/tools.js';
import type { PageStage } from './page_stage.js';
import type { StoryHost } from './story_host.js';

export class ToolHost {
  private tools: Toolbox | null = null;
  private linked: string | null = null;
  private hasNews = false;

  constructor(private readonly stage: PageStage, private readonly story: StoryHost) {
    stage.context.addEventListener('known', () => { this.showNews(); });
  }

  /// As links have them.
  get notes(): string | null {
    return this.linked;
  }

  /// A link's notes, instead of those before.
  follow(spot: Spot): void {
    this.linked = choiceOf(spot, 'notes');
    this.hasNews = this.linked !== null && this.tools === null;
    this.tools?.follow(this.linked);
  }

  /// Null: the bar. Nothing happens before something is known of the model.
  async use(name: ToolName | null): Promise<void> {
    const { view, signal, context } = this.stage;
    if (view.manifest === null) return;
    try {
      const { Toolbox } = await import('../tools/toolbox.js');
      if (signal.aborted) return;
      if (this.tools === null) {
        const tools = new Toolbox(this.stage, this.story, this.linked, (notes) => { this.setNotes(notes); });
        view.registerPlugin(tools);
        this.tools = tools;
      }
      this.tools.toggle(name);
    } catch {
      context.missCode(() => void this.use(name));
    }
  }

  back(): boolean {
    return this.tools?.back() ?? false;
  }

  /// The notes of a link are shown once something is known of the model.
  private showNews(): void {
    if (this.hasNews) void this.use('notes');
    this.hasNews = false;
  }

  private setNotes(notes: string | null): void {
    this.linked = notes;
    this.stage.context.rest();
  }
}
