// SPDX-License-Identifier: MIT
// What the tools need of the view, and the view of the tools.
import type { PerspectiveCamera } from 'three';
import type { HierarchyView } from '../../src/index.js';
import type { Notebook } from '../../src/tools/note.js';
import type { DrawPart, PictureSize } from '../../src/tools/screenshot.js';
import type { Telling } from '../problems.js';
import type { CameraPose } from '../../src/scene/camera_pose.js';
import type { Painter } from '../view/stage.js';

export type ToolName = 'pick' | 'measure' | 'clip' | 'notes' | 'camera';

export interface Bench {
  readonly name: string;
  /// Of the hierarchy: its story lies beside it under that name and ".story.json".
  readonly fileName: string;
  readonly view: HierarchyView;
  readonly camera: PerspectiveCamera;
  /// Holds everything around the picture.
  readonly root: HTMLElement;
  /// What the picture is drawn on, and has the focus.
  readonly surface: HTMLElement;
  /// Aborts with the view.
  readonly signal: AbortSignal;
  pose(): CameraPose;
  /// At once, or on a way that is seen unless less motion is asked for, and only to where a camera can stand.
  jump(pose: CameraPose): void;
  fly(pose: CameraPose): void;
  /// How the model is shown, as links have it.
  choices(): string;
  /// Shows the notes as visitors see them, from the note of that number on, the first of which is 0.
  play(story: Notebook, from: number): void;
  /// What is told beside the model; null: nothing, or it has not come yet.
  story(): Notebook | null;
  /// What the address has of notes; null takes it away.
  readonly notes: string | null;
  setNotes(notes: string | null): void;
  /// From now on the camera stands, the view refines for a picture of that size, and the page shows what it shows, until it is released.
  freeze(size: PictureSize): { readonly draw: DrawPart; release(): void };
  redraw(): void;
  /// Draws instead of the view, until null is given.
  setPainter(painter: Painter | null): void;
  /// What it returns takes the message away.
  tell(message: string, telling?: Pick<Telling, 'more' | 'retry'>): () => void;
}

/// Places of the picture are from -1 to 1 to the right and up.
export interface Tools {
  /// Null: the bar alone, or nothing any more if it is there.
  toggle(name: ToolName | null): void;
  /// False: no tool has use for it.
  tapped(right: number, up: number): boolean;
  /// After each frame.
  drawn(): void;
  /// Puts away the tool, then the bar. False: nothing is there.
  back(): boolean;
  /// Another link is followed, with these notes.
  follow(notes: string | null): void;
}
