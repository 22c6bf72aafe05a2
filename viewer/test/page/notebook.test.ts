// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { NotebookStore } from '../../page/tools/notebook.js';
import { ToolLink } from '../../page/tools/tool_link.js';
import { MOST_ENTRIES, packNotes, unpackNotes, type Note } from '../../src/tools/notes.js';

const noteOf = (text: string): Note => ({ at: [1, 2, 3], text });
const linkOf = (...texts: readonly string[]): string => `notes=${packNotes({ notes: texts.map(noteOf), bookmarks: [] })!}`;

function opened(text: string): { store: NotebookStore; link: ToolLink; written: string[]; texts: () => string[] } {
  const written: string[] = [];
  const link = new ToolLink(text, (each) => { written.push(each); });
  const store = new NotebookStore(link);
  return { store, link, written, texts: () => store.notes.map(({ text }) => text) };
}

describe('the notes of an open model', () => {
  it('are those of the link, and the link is what they are', () => {
    const { store, written, texts } = opened(linkOf('a'));
    expect(texts()).toEqual(['a']);
    store.add({ notes: [noteOf('b')], bookmarks: [] });
    expect(unpackNotes(written.at(-1)!.replace('notes=', ''))).toEqual({ notes: [noteOf('a'), noteOf('b')], bookmarks: [] });
    store.notes = [];
    store.changed();
    expect(written.at(-1)).toBe('');
  });

  it('follow another link, and stay with the same', () => {
    const { store, link, texts } = opened('');
    let changes = 0;
    store.onChange(() => { ++changes; });
    link.follow(linkOf('a'));
    link.follow(linkOf('a'));
    expect([texts(), changes]).toEqual([['a'], 1]);
    link.follow(linkOf('b', 'c'));
    expect(texts()).toEqual(['b', 'c']);
    link.follow('');
    expect(texts()).toEqual([]);
  });

  it('stay beside those of another link where no link holds them', () => {
    const long = 'x'.repeat(1900);
    const { store, link, written, texts } = opened(linkOf('a'));
    store.add({ notes: [noteOf(long)], bookmarks: [] });
    expect([store.isInLink, written.at(-1)]).toEqual([false, '']);
    link.follow(linkOf('b'));
    expect(texts()).toEqual(['a', long, 'b']);
  });

  it('of a broken link are none, and it is put right', () => {
    const { written, texts } = opened('notes=%%%');
    expect([texts(), written]).toEqual([[], ['']]);
  });

  it('are no more than a file may have', () => {
    const { store } = opened('');
    for (let i = 0; i < 2; ++i) store.add({ notes: Array.from({ length: MOST_ENTRIES - 1 }, () => noteOf('')), bookmarks: [] });
    expect(store.notes).toHaveLength(MOST_ENTRIES);
  });
});
