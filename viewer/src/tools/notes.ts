// SPDX-License-Identifier: MIT
// Notes at points, and places of the camera, as a file or in a link. Whatever is read, what comes out is sound.
import { JsonValue, type Fail } from '../json_value.js';
import type { Languages } from './annotation_bodies.js';
import { annotationsOf, readAnnotations } from './annotations.js';
import { MOST_ENTRIES, MOST_STORY_BYTES, MOST_TEXT, NotesProblem, type Note, type Notebook, type SeenFrom } from './note.js';

export { MOST_ENTRIES, MOST_TEXT, NotesProblem, type Bookmark, type Note, type Notebook, type SeenFrom } from './note.js';

const FORMAT = 'meshhier-notes';
const VERSION = 1;
/// Characters in a link that every program passes on.
const MOST_LINK = 1500;

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

function readView(view: JsonValue): SeenFrom {
  return { position: view.at('position').place(), target: view.at('target').place(), choices: view.has('choices') ? readText(view.at('choices')) : '' };
}

/// Pictures and links are not followed from here: anybody can write the address of a page.
function readNote(note: JsonValue): Note {
  return { at: note.at('at').place(), text: readText(note.at('text')), ...(note.has('view') ? { view: readView(note.at('view')) } : {}) };
}

function readNotebook(root: JsonValue): Notebook {
  root.at('format').oneOf(FORMAT);
  root.at('version').count(VERSION, VERSION);
  return {
    ...(root.has('title') ? { title: readText(root.at('title')) } : {}),
    notes: readList(root.at('notes'), readNote),
    bookmarks: readList(root.at('bookmarks'), (mark) => ({ name: readText(mark.at('name')), position: mark.at('position').place(), target: mark.at('target').place() })),
  };
}

/// Notes as formatNotes() writes them, or as pages wrote them before there were stories, or others' annotations, in the first of the
/// reader's languages that they have. Throws NotesProblem.
export function readNotes(text: string, languages: Languages = []): Notebook {
  if (text.length > MOST_STORY_BYTES) refuse(`larger than ${MOST_STORY_BYTES} bytes`);
  const root = JsonValue.parse(text, refuse);
  return root.has('format') ? readNotebook(root) : readAnnotations(root, languages, refuse);
}

/// `model`: what they are about, for people.
export function formatNotes(notebook: Notebook, model: string): string {
  return `${JSON.stringify(annotationsOf(notebook, model), null, 2)}\n`;
}

export function isEmpty({ notes, bookmarks }: Notebook): boolean {
  return notes.length + bookmarks.length === 0;
}

/// Letters, digits, - and _ alone; null: too long for a link, or with pictures or links, which need a file.
export function packNotes({ title, notes, bookmarks }: Notebook): string | null {
  if (notes.some(({ picture, link }) => (picture ?? link ?? null) !== null)) return null;
  const texts = notes.map(({ at, text, view }) => ({ at, text, ...(view ? { view } : {}) }));
  const bytes = new TextEncoder().encode(JSON.stringify({ format: FORMAT, version: VERSION, ...(title ? { title } : {}), notes: texts, bookmarks }));
  if (bytes.length > MOST_LINK) return null;
  const packed = btoa(String.fromCharCode(...bytes)).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
  return packed.length > MOST_LINK ? null : packed;
}

/// Null of what packNotes() did not make.
export function unpackNotes(packed: string): Notebook | null {
  try {
    if (packed.length > MOST_LINK) return null;
    const bytes = Uint8Array.from(atob(packed.replaceAll('-', '+').replaceAll('_', '/')), (sign) => sign.charCodeAt(0));
    return readNotebook(JsonValue.parse(new TextDecoder('utf-8', { fatal: true }).decode(bytes), refuse));
  } catch {
    return null;
  }
}
