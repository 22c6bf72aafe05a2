// SPDX-License-Identifier: MIT
// A note as it is written: its text, and what a story has of it: a view, a picture, a link, its place among the others.
import { MOST_TEXT, type Note, type SeenFrom } from '../../src/tools/note.js';
import { element, iconButton } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { textButton } from './figures.js';
import { TOOL_ICONS } from './icons.js';
import { notePicture } from './note_picture.js';
import { words } from './words/words.js';

export interface NoteOrders {
  change(change: Partial<Note>): void;
  /// Where the camera is, and how the model is shown.
  seen(): SeenFrom;
  go(): void;
  remove(): void;
  /// By so many places; null: it is the first or the last.
  up: (() => void) | null;
  down: (() => void) | null;
  failed(message: string): void;
}

const MOST_ROWS = 4;

/// Enter begins a line, with Ctrl (or Cmd) it ends the text.
function textField(note: Note, name: string, orders: NoteOrders): HTMLTextAreaElement {
  const field = element('textarea', { class: 'tool-text', title: words.notes.writing, 'aria-label': name, maxlength: String(MOST_TEXT) });
  const fit = (): void => { field.rows = Math.min(field.value.split('\n').length, MOST_ROWS); };
  field.value = note.text;
  fit();
  field.addEventListener('input', fit);
  field.addEventListener('keydown', (event) => {
    if (event.key !== 'Enter' || !(event.ctrlKey || event.metaKey) || event.isComposing) return;
    event.preventDefault();
    field.blur();
  });
  field.addEventListener('change', () => { orders.change({ text: field.value }); });
  return field;
}

function viewButtons({ view }: Note, orders: NoteOrders): HTMLElement[] {
  const keep = textButton(view ? words.notes.newView : words.notes.keepView, () => { orders.change({ view: orders.seen() }); });
  return view ? [keep, textButton(words.notes.noView, () => { orders.change({ view: null }); })] : [keep];
}

function pictureButtons({ picture }: Note, orders: NoteOrders): HTMLElement[] {
  const file = element('input', { type: 'file', accept: 'image/*', class: 'note-file', hidden: true, tabindex: '-1', 'aria-hidden': 'true' });
  file.addEventListener('change', () => {
    const [given] = file.files ?? [];
    if (given !== undefined) notePicture(given).then((made) => { orders.change({ picture: made }); }, () => { orders.failed(words.notes.badPicture(given.name)); });
  });
  const choose = textButton(picture ? words.notes.newPicture : words.notes.picture, () => { file.click(); });
  return [choose, ...(picture ? [textButton(words.notes.noPicture, () => { orders.change({ picture: null }); })] : []), file];
}

function linkField({ link }: Note, orders: NoteOrders): HTMLElement {
  const field = element('input', { type: 'url', class: 'tool-text', placeholder: 'https://', maxlength: String(MOST_TEXT) });
  field.value = link ?? '';
  field.addEventListener('change', () => { orders.change({ link: field.value.trim() || null }); });
  return element('label', { class: 'tool-field' }, words.notes.link, field);
}

function mover(name: string, path: string, move: (() => void) | null): HTMLButtonElement {
  const button = iconButton(name, path, () => { move?.(); });
  button.disabled = move === null;
  return button;
}

/// `name`: what it is called, with its number. `open`: what a story has of it is shown.
export function noteRow(note: Note, name: string, orders: NoteOrders, open: boolean, opened: (open: boolean) => void): HTMLElement {
  const line = element('div', { class: 'note-line' }, textField(note, name, orders), iconButton(words.list.go(name), TOOL_ICONS.go, () => { orders.go(); }), iconButton(words.list.remove(name), ICONS.close, () => { orders.remove(); }));
  const places = element('div', { class: 'note-places' }, mover(words.notes.earlier(name), ICONS.up, orders.up), mover(words.notes.later(name), ICONS.down, orders.down));
  const more = element('details', { class: 'note-more', open }, element('summary', { 'aria-label': words.notes.more(name) }, words.notes.moreShort), ...viewButtons(note, orders), ...pictureButtons(note, orders), linkField(note, orders), places);
  more.addEventListener('toggle', () => { opened(more.open); });
  return element('li', { class: 'note' }, line, more);
}
