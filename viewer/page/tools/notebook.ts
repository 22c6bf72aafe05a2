// SPDX-License-Identifier: MIT
// The notes and bookmarks of the open model: in the page's address while they are short.
import { readLink, writeLink } from '../../src/view/view_link.js';
import type { ToolLink } from './tool_link.js';
import { isEmpty, MOST_ENTRIES, packNotes, unpackNotes, type Bookmark, type Note, type Notebook } from '../../src/tools/notes.js';

const NOTHING: Notebook = { notes: [], bookmarks: [] };

export class NotebookStore {
  title = '';
  notes: Note[] = [];
  bookmarks: Bookmark[] = [];
  /// The page's address has all that is kept, too.
  isInLink = true;
  private readonly listeners: (() => void)[] = [];

  constructor(private readonly link: ToolLink) {
    link.onFollow(() => { this.follow(); });
    this.follow();
  }

  /// Takes what a link has, instead of what the one before had; what no link holds stays.
  private follow(): void {
    const { notes } = readLink(this.link.text);
    if (this.isInLink) [this.title, this.notes, this.bookmarks] = ['', [], []];
    this.add((notes === undefined ? null : unpackNotes(notes)) ?? NOTHING);
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  /// As many as there is room for. A title that there is stays.
  add({ title, notes, bookmarks }: Notebook): void {
    this.title ||= title ?? '';
    this.notes = [...this.notes, ...notes].slice(0, MOST_ENTRIES);
    this.bookmarks = [...this.bookmarks, ...bookmarks].slice(0, MOST_ENTRIES);
    this.changed();
  }

  /// Notes that are at that point move to another.
  moveNote(from: Note['at'], to: Note['at']): void {
    this.notes = this.notes.map((note) => (note.at === from ? { ...note, at: to } : note));
    this.changed();
  }

  changed(): void {
    const notes = isEmpty(this) ? null : packNotes(this);
    this.isInLink = isEmpty(this) || notes !== null;
    this.link.write(writeLink({ notes: notes ?? undefined }));
    for (const listener of this.listeners) listener();
  }
}
