// SPDX-License-Identifier: MIT
// People tell this of a model: notes at points, which are a story in their order, and places of the camera.
import type { Vector } from './vectors.js';

/// How a place is looked at. In the input's coordinates.
export interface SeenFrom {
  readonly position: Vector;
  readonly target: Vector;
  /// NAME=VALUE of how it is shown, with & between, as the page's links have them; empty: as it is.
  readonly choices: string;
}

export interface Note {
  /// In the input's coordinates.
  readonly at: Vector;
  readonly text: string;
  /// Null, or missing: from wherever the camera is.
  readonly view?: SeenFrom | null;
  /// The address of a picture, relative to the story's, or a picture itself: `data:image/…`.
  readonly picture?: string | null;
  /// An address that leads on.
  readonly link?: string | null;
}

/// In the input's coordinates.
export interface Bookmark {
  readonly name: string;
  readonly position: Vector;
  readonly target: Vector;
}

export interface Notebook {
  /// The title of the story that the notes tell in their order.
  readonly title?: string;
  readonly notes: readonly Note[];
  readonly bookmarks: readonly Bookmark[];
  /// So many annotations were read and are neither; missing: none.
  readonly leftOut?: number;
}

/// Each list has at most so many.
export const MOST_ENTRIES = 500;
/// Characters of a text.
export const MOST_TEXT = 2000;
/// A file has at most so many bytes.
export const MOST_STORY_BYTES = 2 ** 24;

/// Says what is wrong with a file of notes.
export class NotesProblem extends Error {}
