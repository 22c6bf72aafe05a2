// SPDX-License-Identifier: MIT
// The story of a model: found once the model is seen, told where its code is loaded, and at which note a link is.
import type { Notebook } from '../../src/tools/note.js';
import type { StoryPlayer } from '../story/story_player.js';
import { words } from '../words/words.js';
import { readLink, writeLink } from '../../src/view/view_link.js';
import type { PageStage } from './page_stage.js';

interface Story {
  readonly notebook: Notebook;
  /// Where it lies; null: in the page itself.
  readonly address: string | null;
}

export class StoryHost {
  private story: Story | null = null;
  private player: StoryPlayer | null = null;
  private step: number | null = null;
  private sought = false;

  constructor(private readonly stage: PageStage) {
    const { context } = stage;
    context.addEventListener('known', () => { if (context.isShown) this.seek(); });
  }

  /// As links have it; '': no note is told.
  get text(): string {
    return this.step === null ? '' : writeLink({ story: this.step + 1 });
  }

  /// The story that lies beside the model; null: there is none, or it has not come yet.
  get told(): Notebook | null {
    return this.story?.notebook ?? null;
  }

  /// The address of that; null: it has none.
  get address(): string | null {
    return this.story?.address ?? null;
  }

  /// A link's note.
  follow(choices: string): void {
    const { story } = readLink(choices);
    this.step = story === undefined ? null : story - 1;
    if (this.step !== null) this.player?.stories.stand(this.step);
  }

  /// Shows what was written with the tools as visitors see it, instead of what is told; `from`: the first note, from 0 on.
  play(notebook: Notebook, from: number): void {
    this.open({ notebook, address: this.address }).then(
      () => { this.player?.stories.go(from); },
      () => { this.stage.context.missCode(() => { this.play(notebook, from); }); },
    );
  }

  toggle(): void {
    if (this.player !== null) this.end();
    else if (this.story !== null) void this.open(this.story);
  }

  /// False: none is told.
  back(): boolean {
    const isTold = this.player !== null;
    if (isTold) this.end();
    return isTold;
  }

  /// Looks for the model's story, and shows that there is one.
  private seek(): void {
    if (this.sought) return;
    this.sought = true;
    this.load().catch((error: unknown) => {
      const { page, model } = this.stage.context;
      const retry = (): void => {
        this.sought = false;
        this.seek();
      };
      page.problems.tell(words.story.notRead(model.name), { more: error instanceof Error ? error.message : String(error), subject: 'story', retry });
    });
  }

  private async load(): Promise<void> {
    const { signal, context } = this.stage;
    const found = await context.arrival.findStory(signal);
    if (found === null) return;
    const { loadStory } = await import('../story/story_source.js');
    const notebook = await loadStory(found, signal);
    if (signal.aborted || notebook.notes.length === 0) return;
    this.story = { notebook, address: found.startsWith('{') ? null : found };
    if (this.player === null) await this.open(this.story);
  }

  private async open({ notebook, address }: Story): Promise<void> {
    const { StoryPlayer } = await import('../story/story_player.js');
    const { stage } = this;
    if (stage.signal.aborted) return;
    this.player?.end();
    const base = stage.context.model.files === undefined ? (address ?? document.baseURI) : null; // a page that has the model within it fetches nothing
    this.player = new StoryPlayer(notebook, base, stage, () => { this.end(); });
    this.player.stories.addEventListener('told', () => { this.moved(); });
    if (this.step !== null) this.player.stories.stand(this.step);
    stage.context.dispatchEvent({ type: 'story', isTold: true });
  }

  /// Links tell of another note.
  private moved(): void {
    this.step = this.player?.stories.step ?? null;
    this.stage.context.startRest();
    this.stage.redraw();
  }

  private end(): void {
    this.player?.end();
    this.player = null;
    this.stage.context.dispatchEvent({ type: 'story', isTold: false });
    this.moved();
  }
}
