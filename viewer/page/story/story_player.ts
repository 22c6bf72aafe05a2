// SPDX-License-Identifier: MIT
// A story that is told: its card, and its notes on the model.
import { Stories } from '../../src/plugins/stories.js';
import type { Plugin } from '../../src/index.js';
import type { Notebook } from '../../src/tools/note.js';
import type { Bench } from '../tools/bench.js';
import { StoryCard } from './story_card.js';
import { StoryMarks } from './story_marks.js';
import './story.css';

export class StoryPlayer implements Plugin {
  readonly name = 'page story';
  readonly stories: Stories;
  private readonly card: StoryCard;
  private readonly marks: StoryMarks;

  /// `base`: where the story lies; null: in the page. Requires that the manifest is there. `ended`: the visitor has closed it.
  constructor(story: Notebook, base: string | null, private readonly stage: Bench, ended: () => void) {
    this.stories = new Stories(story, 'page stories');
    this.card = new StoryCard(story, base, {
      go: (i) => { this.goByHand(i); },
      play: () => { this.stories.togglePlaying(); },
      close: ended,
    });
    this.marks = new StoryMarks(story.notes.map(({ text }) => text), (i) => { this.goByHand(i); });
    for (const plugin of [this.stories, this]) stage.view.registerPlugin(plugin);
    stage.surface.after(this.marks.root); // behind all bars
    stage.root.append(this.card.root);
    stage.root.classList.add('with-story');
    this.stories.addEventListener('shown', () => { this.showStep(); });
    this.stories.addEventListener('playing', () => { this.card.showPlaying(this.stories.isPlaying); });
    this.showStep();
  }

  drawn(): void {
    const { surface, camera } = this.stage;
    this.marks.place(this.stories.marks(), camera, surface);
  }

  end(): void {
    for (const plugin of [this.stories, this]) this.stage.view.unregisterPlugin(plugin);
    this.card.root.remove();
    this.marks.root.remove();
    this.stage.root.classList.remove('with-story');
  }

  private goByHand(i: number): void {
    this.stories.pause();
    this.stories.go(i);
  }

  private showStep(): void {
    const { step } = this.stories;
    this.card.show(step);
    this.marks.current(step);
  }
}
