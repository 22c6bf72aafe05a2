// SPDX-License-Identifier: MIT
// Notes at points, and places of the camera, as a file or in a link. Whatever is read, what comes out is sound.
import { JsonValue, type Fail } from '../json_value.js';
import type { Vector } from './vectors.js';

export interface Note {
  /// In the input's coordinates.
  readonly at: Vector;
  readonly text: string;
}

/// In the input's coordinates.
export interface Bookmark {
  readonly name: string;
  readonly position: Vector;
  readonly target: Vector;
}

export interface Notebook {
  readonly notes: readonly Note[];
  readonly bookmarks: readonly Bookmark[];
}

const FORMAT = 'meshhier-notes';
const VERSION = 1;
/// Of each list.
export const MOST_ENTRIES = 500;
/// Characters of a text.
export const MOST_TEXT = 2000;
const MOST_BYTES = 2 ** 22;
/// Characters in a link that every program passes on.
const MOST_LINK = 1500;

/// What is wrong with a file of notes.
export class NotesProblem extends Error {}

const refuse: Fail = (what) => {
  throw new NotesProblem(what);
};

function readList<Entry>(list: JsonValue, read: (entry: JsonValue) => Entry): Entry[] {
  const entries = list.items();
  if (entries.length > MOST_ENTRIES) refuse(`more than ${MOST_ENTRIES} entries`);
  return entries.map(read);
}

function readText(value: JsonValue): string {
  return value.text().slice(0, MOST_TEXT);
}

function readNotebook(root: JsonValue): Notebook {
  root.at('format').oneOf(FORMAT);
  root.at('version').count(VERSION, VERSION);
  return {
    notes: readList(root.at('notes'), (note) => ({ at: note.at('at').triple(), text: readText(note.at('text')) })),
    bookmarks: readList(root.at('bookmarks'), (mark) => ({ name: readText(mark.at('name')), position: mark.at('position').triple(), target: mark.at('target').triple() })),
  };
}

/// Throws NotesProblem.
export function readNotes(text: string): Notebook {
  if (text.length > MOST_BYTES) refuse(`larger than ${MOST_BYTES} bytes`);
  return readNotebook(JsonValue.parse(text, refuse));
}

/// `model`: what they are about, for people.
export function formatNotes({ notes, bookmarks }: Notebook, model: string): string {
  return `${JSON.stringify({ format: FORMAT, version: VERSION, model, notes, bookmarks }, null, 2)}\n`;
}

export function isEmpty({ notes, bookmarks }: Notebook): boolean {
  return notes.length + bookmarks.length === 0;
}

/// Letters, digits, - and _ alone; null: too long for a link.
export function packNotes({ notes, bookmarks }: Notebook): string | null {
  const bytes = new TextEncoder().encode(JSON.stringify({ format: FORMAT, version: VERSION, notes, bookmarks }));
  if (bytes.length > MOST_LINK) return null;
  const packed = btoa(String.fromCharCode(...bytes)).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
  return packed.length > MOST_LINK ? null : packed;
}

/// Null of what packNotes() did not make.
export function unpackNotes(packed: string): Notebook | null {
  try {
    if (packed.length > MOST_LINK) return null;
    const bytes = Uint8Array.from(atob(packed.replaceAll('-', '+').replaceAll('_', '/')), (sign) => sign.charCodeAt(0));
    return readNotes(new TextDecoder('utf-8', { fatal: true }).decode(bytes));
  } catch {
    return null;
  }
}
