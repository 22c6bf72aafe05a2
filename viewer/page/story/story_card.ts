// SPDX-License-Identifier: MIT
// Shows a story note by note: text, picture, link, and the way through it. Read only.
import type { Stories } from '../../src/plugins/stories.js';
import type { Note } from '../../src/tools/note.js';
import { resolveUrl } from '../listing.js';
import { formatCount } from '../numbers.js';
import { element, iconButton } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { words } from '../words/words.js';
import { pictureOf } from './story_source.js';

export class StoryCard {
  readonly root: HTMLElement;
  private readonly step = element('p', { class: 'story-step' });
  private readonly body = element('div', { class: 'story-body', 'aria-live': 'polite', tabindex: '-1' });
  private readonly before: HTMLButtonElement;
  private readonly next: HTMLButtonElement;
  private readonly playing: HTMLButtonElement;

  /// `base`: where the story lies; null: in the page, which fetches nothing for it. `ended`: the visitor has closed it.
  constructor(private readonly stories: Stories, private readonly base: string | null, ended: () => void) {
    const title = stories.story.title || words.story.title;
    this.before = iconButton(words.story.before, ICONS.back, () => { stories.turnTo((stories.step ?? 0) - 1); });
    this.next = iconButton(words.story.next, ICONS.next, () => { stories.turnTo((stories.step ?? -1) + 1); });
    this.playing = iconButton(words.story.play, ICONS.play, () => { stories.togglePlaying(); });
    const close = iconButton(words.parts.close(words.story.title), ICONS.close, ended);
    const bar = element('div', { class: 'story-bar' }, this.before, this.playing, this.next, this.step);
    stories.addEventListener('shown', () => { this.show(stories.step); });
    stories.addEventListener('playing', () => { this.showPlaying(stories.isPlaying); });
    this.root = element('section', { class: 'story-card', 'aria-label': `${words.story.title}: ${title}` }, element('div', { class: 'sheet-head' }, element('h2', {}, title), close), this.body, bar);
    this.show(stories.step);
  }

  /// Null: none yet.
  private show(i: number | null): void {
    const { notes } = this.stories.story;
    this.step.textContent = i === null ? words.story.notes(notes.length, String(notes.length)) : words.story.step(String(i + 1), String(notes.length));
    this.before.disabled = i === null || i === 0;
    this.next.disabled = i === notes.length - 1;
    this.body.replaceChildren(...(i === null ? this.startOf() : this.contentOf(notes[i], i)));
    this.body.scrollTop = 0;
  }

  private showPlaying(isPlaying: boolean): void {
    const [name, path] = isPlaying ? [words.story.pause, ICONS.pause] : [words.story.play, ICONS.play];
    this.playing.title = name;
    this.playing.setAttribute('aria-label', name);
    this.playing.querySelector('path')?.setAttribute('d', path);
  }

  /// Before the first note: what of the file is not told.
  private startOf(): HTMLElement[] {
    const { leftOut = 0 } = this.stories.story;
    return leftOut === 0 ? [] : [element('p', { class: 'tool-note' }, words.story.leftOut(leftOut, formatCount(leftOut)))];
  }

  private contentOf({ text, picture, link }: Note, i: number): HTMLElement[] {
    const content: HTMLElement[] = [];
    const source = pictureOf(picture, this.base);
    if (source !== null) {
      const image = element('img', { class: 'story-picture', src: source, alt: words.story.picture(String(i + 1)), referrerpolicy: 'no-referrer' });
      image.addEventListener('error', () => { image.replaceWith(element('p', { class: 'tool-note' }, words.story.noPicture)); });
      content.push(image);
    }
    if (text !== '') content.push(element('p', { class: 'story-text' }, text));
    const href = link ? resolveUrl(link, this.base ?? document.baseURI) : null;
    if (href !== null) content.push(element('a', { class: 'story-link', href, target: '_blank', rel: 'noopener noreferrer' }, words.story.more(new URL(href).host)));
    return content;
  }
}
