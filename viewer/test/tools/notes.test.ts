// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { formatNotes, MOST_ENTRIES, MOST_TEXT, NotesProblem, packNotes, readNotes, unpackNotes, type Notebook } from '../../src/tools/notes.js';

const NOTEBOOK: Notebook = {
  notes: [{ at: [0.1, -691000.123456789, 5e-324], text: 'Riß <b>„hier“</b> 裂け目' }],
  bookmarks: [{ name: 'from above', position: [0, 10, 0.1], target: [0, 0, 0] }],
};

/// As pages wrote them before there were stories, and as links have them.
const OLDER = JSON.stringify({ format: 'meshhier-notes', version: 1, model: 'a', ...NOTEBOOK });

function changed(change: (json: { notes: unknown; bookmarks: unknown; version: unknown; format: unknown }) => void): string {
  const json = JSON.parse(OLDER) as Parameters<typeof change>[0];
  change(json);
  return JSON.stringify(json);
}

describe('notes', () => {
  it('come back from their file, to the bit', () => {
    expect(readNotes(formatNotes(NOTEBOOK, 'model'))).toEqual({ title: 'model', ...NOTEBOOK });
  });

  it('come back from a file of before', () => {
    expect(readNotes(OLDER)).toEqual(NOTEBOOK);
  });

  it('with a title and views come back from a link, with pictures or links they are in none', () => {
    const [note] = NOTEBOOK.notes;
    const seen = { ...note, view: { position: [1, 2, 3], target: [0, 0, 1e-9], choices: 'light=raking&wires=on' } } as const;
    const told = { title: 'A tour', notes: [seen, note], bookmarks: [] };
    expect(unpackNotes(packNotes(told)!)).toEqual(told);
    expect(packNotes({ ...told, notes: [{ ...seen, picture: 'a.jpg' }] })).toBeNull();
    expect(packNotes({ ...told, notes: [{ ...seen, link: 'https://example.org' }] })).toBeNull();
    expect(packNotes({ ...told, notes: [{ ...seen, link: null, picture: null }] })).not.toBeNull();
  });

  it('of a link never have pictures or links', () => {
    const hostile = { format: 'meshhier-notes', version: 1, notes: [{ at: [0, 0, 0], text: '', picture: 'https://spy.example/1.gif', link: 'https://spy.example' }], bookmarks: [] };
    expect(unpackNotes(btoa(JSON.stringify(hostile)))).toEqual({ notes: [{ at: [0, 0, 0], text: '' }], bookmarks: [] });
  });

  it('come back from a link, whose letters need no escape', () => {
    const packed = packNotes(NOTEBOOK)!;
    expect(packed).toMatch(/^[\w-]+$/);
    expect(unpackNotes(packed)).toEqual(NOTEBOOK);
  });

  it('that are too long are in no link', () => {
    expect(packNotes({ notes: [{ at: [0, 0, 0], text: 'x'.repeat(1400) }], bookmarks: [] })).toBeNull();
    expect(packNotes({ notes: [{ at: [0, 0, 0], text: 'x'.repeat(1e6) }], bookmarks: [] })).toBeNull();
    expect(packNotes({ notes: [{ at: [0, 0, 0], text: 'x'.repeat(200) }], bookmarks: [] })).not.toBeNull();
  });

  it.each([
    ['no JSON', '{'],
    ['another format', changed((json) => { json.format = 'x'; })],
    ['another version', changed((json) => { json.version = 2; })],
    ['no list', changed((json) => { json.notes = {}; })],
    ['no number', changed((json) => { json.notes = [{ at: [1, 2, 'x'], text: '' }]; })],
    ['a number too large', OLDER.replace('0.1,', '1e999,')],
    ['too few numbers', changed((json) => { json.bookmarks = [{ name: '', position: [1, 2], target: [0, 0, 0] }]; })],
    ['too many', changed((json) => { json.notes = Array.from({ length: MOST_ENTRIES + 1 }, () => NOTEBOOK.notes[0]); })],
    ['too long', ' '.repeat(2 ** 24 + 1)],
  ])('refuse %s', (_, text) => {
    expect(() => readNotes(text)).toThrow(NotesProblem);
  });

  it('cut texts that are longer than they may be', () => {
    const long = formatNotes({ notes: [{ at: [0, 0, 0], text: 'x'.repeat(MOST_TEXT + 1) }], bookmarks: [] }, '');
    expect(readNotes(long).notes[0].text).toHaveLength(MOST_TEXT);
  });

  it.each(['', '!', 'bm90IGpzb24', '%%%', 'x'.repeat(9999)])('of the link "%.10s" are none', (packed) => {
    expect(unpackNotes(packed)).toBeNull();
  });
});
