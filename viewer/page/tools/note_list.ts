// SPDX-License-Identifier: MIT
// The notes as they are written: of each its text, and what a story has of it: a view, a picture, a link, its place among the others.
import { MOST_TEXT, type Note } from '../../src/tools/note.js';
import { poseOfNote } from '../../src/tools/note_pose.js';
import { element, iconButton } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { textButton } from './figures.js';
import { notePicture } from './note_picture.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

const MOST_ROWS = 4;
const CLOSER = 0.25; // of the model's size: from there a note is looked at

export class NoteList {
  readonly root = element('ul', { class: 'tool-list' });
  /// Tells what failed.
  readonly message = element('p', { class: 'tool-note', 'aria-live': 'polite' });
  /// The note of which more than the text is shown.
  private opened: number | null = null;

  constructor(private readonly shop: Workshop) {}

  /// Rows that somebody writes in stay as they are.
  show(): void {
    const { notes } = this.shop.notebook;
    const isWriting = document.activeElement instanceof HTMLTextAreaElement && this.root.contains(document.activeElement) && this.root.childElementCount === notes.length;
    if (!isWriting) this.root.replaceChildren(...notes.map((note, i) => this.rowOf(note, i)));
  }

  remove(i: number): void {
    const { notebook } = this.shop;
    notebook.notes = notebook.notes.filter((_, k) => k !== i);
    notebook.changed();
  }

  /// Notes are told by their numbers: each is another one after a change.
  private change(i: number, change: Partial<Note>): void {
    const { notebook } = this.shop;
    notebook.notes = notebook.notes.map((note, k) => (k === i ? { ...note, ...change } : note));
    notebook.changed();
  }

  private swap(i: number, k: number): void {
    const { notebook } = this.shop;
    const { notes } = notebook;
    this.opened = this.opened === i ? k : this.opened === k ? i : this.opened;
    notebook.notes = notes.map((note, at) => (at === i ? notes[k] : at === k ? notes[i] : note));
    notebook.changed();
  }

  /// Keeps where the camera is, and how the model is shown.
  private keepView(i: number): void {
    const { bench, places } = this.shop;
    const { position, target } = bench.pose();
    this.change(i, { view: { position: places.toInput(position), target: places.toInput(target), choices: bench.choices() } });
  }

  private flyTo(i: number): void {
    const { bench, places, notebook } = this.shop;
    const { min, max } = bench.view.box;
    bench.fly(poseOfNote(notebook.notes[i], places, bench.pose(), CLOSER * min.distanceTo(max)));
  }

  private rowOf(note: Note, i: number): HTMLElement {
    const name = words.notes.one(String(i + 1));
    const go = iconButton(words.list.go(name), ICONS.go, () => { this.flyTo(i); });
    const line = element('div', { class: 'note-line' }, this.textField(note, i, name), go, iconButton(words.list.remove(name), ICONS.close, () => { this.remove(i); }));
    const more = element('details', { class: 'note-more', open: this.opened === i }, element('summary', { 'aria-label': words.notes.more(name) }, words.notes.moreShort),
      ...this.viewButtons(note, i), ...this.pictureButtons(note, i), this.linkField(note, i), this.movers(i, name));
    more.addEventListener('toggle', () => { this.opened = more.open ? i : this.opened === i ? null : this.opened; });
    return element('li', { class: 'note' }, line, more);
  }

  /// Enter begins a line, with Ctrl (or Cmd) it ends the text.
  private textField(note: Note, i: number, name: string): HTMLTextAreaElement {
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
    field.addEventListener('change', () => { this.change(i, { text: field.value }); });
    return field;
  }

  private viewButtons({ view }: Note, i: number): HTMLElement[] {
    const keep = textButton(view ? words.notes.newView : words.notes.keepView, () => { this.keepView(i); });
    return view ? [keep, textButton(words.notes.noView, () => { this.change(i, { view: null }); })] : [keep];
  }

  private pictureButtons({ picture }: Note, i: number): HTMLElement[] {
    const file = element('input', { type: 'file', accept: 'image/*', class: 'note-file', hidden: true, tabindex: '-1', 'aria-hidden': 'true' });
    file.addEventListener('change', () => {
      const [given] = file.files ?? [];
      if (given !== undefined) notePicture(given).then((made) => { this.change(i, { picture: made }); }, () => { this.message.textContent = words.notes.badPicture(given.name); });
    });
    const choose = textButton(picture ? words.notes.newPicture : words.notes.picture, () => { file.click(); });
    return [choose, ...(picture ? [textButton(words.notes.noPicture, () => { this.change(i, { picture: null }); })] : []), file];
  }

  private linkField({ link }: Note, i: number): HTMLElement {
    const field = element('input', { type: 'url', class: 'tool-text', placeholder: 'https://', maxlength: String(MOST_TEXT) });
    field.value = link ?? '';
    field.addEventListener('change', () => { this.change(i, { link: field.value.trim() || null }); });
    return element('label', { class: 'tool-field' }, words.notes.link, field);
  }

  /// The first note has none before it, the last one none after it.
  private movers(i: number, name: string): HTMLElement {
    const earlier = iconButton(words.notes.earlier(name), ICONS.up, () => { this.swap(i - 1, i); });
    const later = iconButton(words.notes.later(name), ICONS.down, () => { this.swap(i, i + 1); });
    earlier.disabled = i === 0;
    later.disabled = i === this.shop.notebook.notes.length - 1;
    return element('div', { class: 'note-places' }, earlier, later);
  }
}
