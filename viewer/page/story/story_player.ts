// SPDX-License-Identifier: MIT
// A story that is told: its card, and its notes on the model.
import { Stories } from '../../src/plugins/stories.js';
import type { Plugin } from '../../src/index.js';
import type { Notebook } from '../../src/tools/note.js';
import type { PageStage } from '../view/page_stage.js';
import { StoryCard } from './story_card.js';
import { StoryMarks } from './story_marks.js';
import './story.css';

export class StoryPlayer implements Plugin {
  readonly name = 'page story';
  readonly stories: Stories;
  private readonly card: StoryCard;
  private readonly marks: StoryMarks;

  /// `base`: where the story lies; null: in the page. Requires that the manifest is there. `ended`: the visitor has closed it.
  constructor(story: Notebook, base: string | null, private readonly stage: PageStage, ended: () => void) {
    this.stories = new Stories(story, 'page stories');
    this.card = new StoryCard(this.stories, base, ended);
    this.marks = new StoryMarks(this.stories);
    for (const plugin of [this.stories, this]) stage.view.registerPlugin(plugin);
    stage.surface.after(this.marks.root); // behind all bars
    stage.root.append(this.card.root);
    stage.root.classList.add('with-story');
  }

  drawn(): void {
    const { surface, camera } = this.stage;
    this.marks.place(camera, surface);
  }

  end(): void {
    for (const plugin of [this.stories, this]) this.stage.view.unregisterPlugin(plugin);
    this.card.root.remove();
    this.marks.root.remove();
    this.stage.root.classList.remove('with-story');
  }
}
