// SPDX-License-Identifier: MIT
// The notes and bookmarks of the open model: in the page's address while they are short.
import { isEmpty, MOST_ENTRIES, packNotes, unpackNotes, type Bookmark, type Note, type Notebook } from '../../src/tools/notes.js';

const NOTHING: Notebook = { notes: [], bookmarks: [] };

export class NotebookStore {
  title = '';
  notes: Note[] = [];
  bookmarks: Bookmark[] = [];
  /// The page's address has all that is kept, too.
  isInLink = true;
  private link: string | null = null;
  private readonly listeners: (() => void)[] = [];

  /// `link`: what the address had; `write`: puts it there, or takes it away.
  constructor(
    link: string | null,
    private readonly write: (link: string | null) => void,
  ) {
    this.follow(link);
  }

  /// Takes what a link has, instead of what the one before had; what no link holds stays.
  follow(link: string | null): void {
    if (link === this.link) return;
    if (this.isInLink) [this.title, this.notes, this.bookmarks] = ['', [], []];
    this.add((link === null ? null : unpackNotes(link)) ?? NOTHING);
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
    const link = isEmpty(this) ? null : packNotes(this);
    this.isInLink = isEmpty(this) || link !== null;
    this.link = link;
    this.write(link);
    for (const listener of this.listeners) listener();
  }
}
