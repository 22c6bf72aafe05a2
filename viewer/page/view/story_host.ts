// SPDX-License-Identifier: MIT
// The story of a model: found once the model is seen, told where its code is loaded, and at which note a link is.
import { choiceOf, type Spot } from '../address.js';
import type { Notebook } from '../../src/tools/note.js';
import type { StoryPlayer, Teller } from '../story/story_player.js';

export interface StorySurroundings {
  /// Null: nothing is known of the model yet.
  teller(): Omit<Teller, 'told' | 'ended'> | null;
  /// The address of the story beside the model, or itself; null: there is none.
  find(): Promise<string | null>;
  /// There is one, and whether it is told.
  shown(isTold: boolean): void;
  /// Links are to tell of another note.
  told(): void;
  /// Whether the page has the model within it, and fetches nothing for what is told.
  isWhole(): boolean;
  /// It could not be had; why.
  failed(why: string, retry: () => void): void;
}

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

  constructor(private readonly around: StorySurroundings) {}

  /// As links have it: from 1 on; null: no note is told.
  get linked(): number | null {
    return this.step === null ? null : this.step + 1;
  }

  /// What lies beside the model.
  get told(): Notebook | null {
    return this.story?.notebook ?? null;
  }

  /// The address of that; null: it has none.
  get address(): string | null {
    return this.story?.address ?? null;
  }

  /// A link's note.
  follow(spot: Spot): void {
    const number = Number(choiceOf(spot, 'story') ?? NaN);
    this.step = Number.isInteger(number) && number > 0 ? number - 1 : null;
    if (this.step !== null) this.player?.stand(this.step);
  }

  /// Once the model is seen: looks for its story, and shows that there is one.
  seek(): void {
    if (this.sought) return;
    this.sought = true;
    this.load().catch((error: unknown) => {
      const retry = (): void => {
        this.sought = false;
        this.seek();
      };
      this.around.failed(error instanceof Error ? error.message : String(error), retry);
    });
  }

  /// What was written with the tools, from its note of that number on, instead of what is told.
  async play(notebook: Notebook, from: number): Promise<void> {
    await this.open({ notebook, address: this.address });
    this.player?.go(from);
  }

  toggle(): void {
    if (this.player !== null) this.end();
    else if (this.story !== null) void this.open(this.story);
  }

  drawn(): void {
    this.player?.drawn();
  }

  /// False: none is told.
  back(): boolean {
    const isTold = this.player !== null;
    if (isTold) this.end();
    return isTold;
  }

  private async load(): Promise<void> {
    const found = await this.around.find();
    const teller = this.around.teller();
    if (found === null || teller === null) return;
    const { loadStory } = await import('../story/story_source.js');
    const notebook = await loadStory(found, teller.signal);
    if (teller.signal.aborted || notebook.notes.length === 0) return;
    this.story = { notebook, address: found.startsWith('{') ? null : found };
    if (this.player === null) await this.open(this.story);
  }

  private async open({ notebook, address }: Story): Promise<void> {
    const { StoryPlayer } = await import('../story/story_player.js');
    const teller = this.around.teller();
    if (teller === null || teller.signal.aborted) return;
    this.player?.end();
    const told = (i: number): void => {
      this.step = i;
      this.around.told();
    };
    this.player = new StoryPlayer(notebook, this.around.isWhole() ? null : (address ?? document.baseURI), { ...teller, told, ended: () => { this.end(); } });
    if (this.step !== null) this.player.stand(this.step);
    this.around.shown(true);
  }

  private end(): void {
    this.player?.end();
    this.player = null;
    this.step = null;
    this.around.shown(false);
    this.around.told();
  }
}
