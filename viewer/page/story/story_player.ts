// SPDX-License-Identifier: MIT
// Tells a story: flies from note to note, shows the model as each of them wants it, and says what it says.
import type { Note, Notebook } from '../../src/tools/note.js';
import type { Bench } from '../tools/bench.js';
import { poseOfNote } from '../tools/note_pose.js';
import { Places } from '../tools/places.js';
import type { CameraPose } from '../../src/scene/camera_pose.js';
import { StoryCard } from './story_card.js';
import { StoryMarks } from './story_marks.js';
import './story.css';

/// A note without a view is looked at from here, in sizes of the model.
const CLOSER = 0.35;
/// For reading, beside the time for each letter.
const LEAST_READING = 3500; // milliseconds
const A_LETTER = 55;
const A_PICTURE = 3000;

export interface Teller extends Pick<Bench, 'view' | 'camera' | 'root' | 'surface' | 'signal' | 'pose'> {
  /// As stories go; the milliseconds that it takes.
  travel(pose: CameraPose): number;
  /// How the model is shown from now on, as links have it.
  present(choices: string): void;
  /// Another note is told.
  told(i: number): void;
  ended(): void;
}

export class StoryPlayer {
  private readonly card: StoryCard;
  private readonly marks: StoryMarks;
  private readonly places: Places;
  private step: number | null = null;
  private timer = 0;
  private isPlaying = false;

  /// `base`: where the story lies; null: in the page. Requires that the manifest is there.
  constructor(private readonly story: Notebook, base: string | null, private readonly teller: Teller) {
    this.places = new Places(teller.view);
    this.card = new StoryCard(story, base, {
      go: (i) => { this.pause(); this.go(i); },
      play: () => { this.togglePlaying(); },
      close: () => { teller.ended(); },
    });
    this.marks = new StoryMarks(story.notes.map(({ text }) => text), (i) => { this.pause(); this.go(i); });
    teller.surface.after(this.marks.root); // behind all bars
    teller.root.append(this.card.root);
    teller.root.classList.add('with-story');
    teller.surface.addEventListener('pointerdown', this.pause, { signal: teller.signal });
    teller.surface.addEventListener('wheel', this.pause, { signal: teller.signal, passive: true });
    teller.signal.addEventListener('abort', this.pause);
    this.show(null);
  }

  /// To the note of that number, if there is one.
  go(i: number): void {
    const note = this.story.notes.at(i);
    if (note === undefined || i < 0) return;
    this.show(i);
    const way = this.fly(note);
    if (this.isPlaying) this.wait(way + LEAST_READING + A_LETTER * note.text.length + (note.picture ? A_PICTURE : 0));
    this.teller.told(i);
  }

  /// As a link says: the note is told, and the camera stands where the link has it.
  stand(i: number): void {
    if (this.story.notes[i] !== undefined) this.show(i);
  }

  drawn(): void {
    const { surface, camera } = this.teller;
    const places = this.story.notes.map(({ at }) => this.places.toWorld(at));
    this.marks.place(places, camera, surface);
  }

  end(): void {
    this.pause();
    this.card.root.remove();
    this.marks.root.remove();
    this.teller.root.classList.remove('with-story');
  }

  /// The way to its view, or closer to it from where the camera is.
  private fly(note: Note): number {
    const { teller } = this;
    const { min, max } = teller.view.box;
    teller.present(note.view?.choices ?? '');
    return teller.travel(poseOfNote(note, this.places, teller.pose(), CLOSER * min.distanceTo(max)));
  }

  private show(i: number | null): void {
    this.step = i;
    this.card.show(i);
    this.marks.current(i);
  }

  private togglePlaying(): void {
    if (this.isPlaying) {
      this.pause();
      return;
    }
    this.isPlaying = true;
    this.card.showPlaying(true);
    const isAtEnd = this.step === null || this.step === this.story.notes.length - 1;
    this.go(isAtEnd ? 0 : this.step! + 1);
  }

  private wait(milliseconds: number): void {
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => {
      if (this.step === this.story.notes.length - 1) this.pause();
      else this.go((this.step ?? -1) + 1);
    }, milliseconds);
  }

  private readonly pause = (): void => {
    window.clearTimeout(this.timer);
    this.isPlaying = false;
    this.card.showPlaying(false);
  };
}
