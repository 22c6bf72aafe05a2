// SPDX-License-Identifier: MIT
// The tools need this of the view, and the view this of the tools.
import type { Plugin, Stage } from '../../src/index.js';
import type { Notebook } from '../../src/tools/note.js';
import type { DrawPart, PictureSize } from '../../src/tools/screenshot.js';
import type { Telling } from '../problems.js';

export type ToolName = 'pick' | 'measure' | 'clip' | 'notes' | 'camera';

export interface Bench extends Stage {
  readonly name: string;
  /// Of the hierarchy: its story lies beside it under that name and ".story.json".
  readonly fileName: string;
  /// Holds everything around the picture.
  readonly root: HTMLElement;
  /// The look of the model, as links have it.
  choices(): string;
  /// From now on the camera stands, the view refines for a picture of that size, and the page shows what it shows, until it is released.
  freeze(size: PictureSize): { readonly draw: DrawPart; release(): void };
  /// What it returns takes the message away.
  tell(message: string, telling?: Pick<Telling, 'more' | 'retry'>): () => void;
}

/// The story of the model.
export interface Teller {
  /// The one that lies beside the model; null: there is none, or it has not come yet.
  readonly told: Notebook | null;
  /// Shows notes as visitors see them, from the note of that number on, the first of which is 0.
  play(story: Notebook, from: number): void;
}

/// A plug-in of the view.
export interface Tools extends Plugin {
  /// Null: the bar alone, or nothing any more if it is there.
  toggle(name: ToolName | null): void;
  /// Puts away the tool, then the bar. False: nothing is there.
  back(): boolean;
  /// Another link is followed, with these notes.
  follow(notes: string | null): void;
}
