// SPDX-License-Identifier: MIT
// Tells a story: goes from note to note, and shows the model as each of them wants it.
import { EventDispatcher, type Vector3 } from 'three';
import type { Plugin, Stage } from '../scene/hierarchy_view.js';
import { poseOfNote } from '../tools/note_pose.js';
import type { Note, Notebook } from '../tools/note.js';
import { Places } from '../tools/places.js';

/// A note without a view is looked at from here, in sizes of the model.
const CLOSER = 0.35;
/// For reading, beside the time for each letter.
const LEAST_READING = 3500; // milliseconds
const A_LETTER = 55;
const A_PICTURE = 3000;

export interface StoryEvents {
  /// Another note is shown.
  shown: object;
  /// The story goes on by itself, or no longer.
  playing: object;
  /// A note was gone to.
  told: object;
}

/// Nothing is told before the view's `manifest` is there.
export class Stories extends EventDispatcher<StoryEvents> implements Plugin {
  private stage: Stage | null = null;
  private places: Places | null = null;
  private current: number | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private isOn = false;

  constructor(readonly story: Notebook, readonly name = 'stories') {
    super();
  }

  /// The number of the note that is shown; null: none yet.
  get step(): number | null {
    return this.current;
  }

  /// The story goes on by itself.
  get isPlaying(): boolean {
    return this.isOn;
  }

  enter(stage: Stage): void {
    this.stage = stage;
    stage.surface.addEventListener('pointerdown', this.pause, { signal: stage.signal });
    stage.surface.addEventListener('wheel', this.pause, { signal: stage.signal, passive: true });
    stage.signal.addEventListener('abort', this.pause);
  }

  /// To the note of that number, if there is one.
  go(i: number): void {
    const note = this.story.notes.at(i);
    if (note === undefined || i < 0 || this.stage?.view.manifest == null) return;
    this.show(i);
    const way = this.travel(this.stage, note);
    if (this.isOn) this.wait(way + LEAST_READING + A_LETTER * note.text.length + (note.picture ? A_PICTURE : 0));
    this.dispatchEvent({ type: 'told' });
  }

  /// By hand: the story no longer goes on by itself.
  turnTo(i: number): void {
    this.pause();
    this.go(i);
  }

  /// The note is shown, and the camera stays where it is.
  stand(i: number): void {
    if (this.story.notes[i] !== undefined) this.show(i);
  }

  togglePlaying(): void {
    if (this.isOn) {
      this.pause();
      return;
    }
    if (this.stage?.view.manifest == null) return;
    this.isOn = true;
    this.dispatchEvent({ type: 'playing' });
    const isAtEnd = this.current === null || this.current === this.story.notes.length - 1;
    this.go(isAtEnd ? 0 : this.current! + 1);
  }

  readonly pause = (): void => {
    clearTimeout(this.timer);
    this.isOn = false;
    this.dispatchEvent({ type: 'playing' });
  };

  /// The places of the notes in the world.
  marks(): Vector3[] {
    const { stage } = this;
    return stage?.view.manifest == null ? [] : this.story.notes.map(({ at }) => this.placesOf(stage).toWorld(at));
  }

  dispose(): void {
    this.pause();
    this.stage?.surface.removeEventListener('pointerdown', this.pause);
    this.stage?.surface.removeEventListener('wheel', this.pause);
    this.stage?.signal.removeEventListener('abort', this.pause);
    this.stage = this.places = null;
  }

  private placesOf({ view }: Stage): Places {
    if (this.places?.manifest !== view.manifest) this.places = null;
    return (this.places ??= new Places(view));
  }

  /// The way to its view, or closer to it from where the camera is.
  private travel(stage: Stage, note: Note): number {
    const { min, max } = stage.view.box;
    stage.present?.(note.view?.choices ?? '');
    return stage.travel(poseOfNote(note, this.placesOf(stage), stage.pose(), CLOSER * min.distanceTo(max)));
  }

  private show(i: number): void {
    this.current = i;
    this.dispatchEvent({ type: 'shown' });
  }

  private wait(milliseconds: number): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      if (this.current === this.story.notes.length - 1) this.pause();
      else this.go((this.current ?? -1) + 1);
    }, milliseconds);
  }
}
