// SPDX-License-Identifier: MIT
// Notes at points of the surface, and the story that they tell in their order; with files of them.
import { formatNotes, readNotes, type Note, type SeenFrom } from '../../src/tools/notes.js';
import type { PickedPoint } from '../../src/tools/picked_point.js';
import { element } from '../parts/element.js';
import { download } from './download.js';
import { textButton } from './figures.js';
import { poseOfNote } from '../../src/tools/note_pose.js';
import { noteRow, type NoteOrders } from './note_row.js';
import type { Mark } from '../../src/plugins/overlay.js';
import { Places } from '../../src/tools/places.js';
import type { Tool } from './tool.js';
import { formatCount } from '../numbers.js';
import { language, words as pageWords } from '../words/words.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

const CLOSER = 0.25; // of the model's size: from there a note is looked at
const MOST_MARK = 40; // letters beside a point
const MOST_TITLE = 200; // letters

export class NotesTool implements Tool {
  readonly root: HTMLElement;
  private readonly list = element('ul', { class: 'tool-list' });
  private readonly note = element('p', { class: 'tool-note', 'aria-live': 'polite' });
  private readonly title = element('input', { type: 'text', class: 'tool-text', maxlength: String(MOST_TITLE) });
  private readonly titleRow = element('label', { class: 'tool-field tool-extra' }, words.notes.title, this.title);
  private readonly play = textButton(words.notes.play, () => { this.tell(); });
  private readonly edit = textButton(words.notes.edit, () => { this.shop.notebook.add(this.shop.story.told!); });
  private readonly places: Places;
  /// The note of which more than the text is shown.
  private opened: number | null = null;
  private readonly ending = new AbortController();

  constructor(private readonly shop: Workshop) {
    const { bench, notebook } = shop;
    this.places = new Places(bench.view);
    const file = element('input', { type: 'file', accept: '.json,application/json', class: 'tool-file', tabindex: '-1', 'aria-hidden': 'true' });
    file.addEventListener('change', () => void this.load(file));
    const save = textButton(words.notes.save, () => { download(new Blob([formatNotes(notebook, bench.name)], { type: 'application/json' }), `${bench.fileName}.story.json`); });
    const load = textButton(words.notes.load, () => { file.click(); });
    for (const button of [save, load]) button.classList.add('tool-extra');
    this.title.addEventListener('change', () => {
      notebook.title = this.title.value.trim();
      notebook.changed();
    });
    this.root = element('div', {}, element('p', { class: 'tool-note' }, words.notes.hint), this.titleRow, this.list, this.note, this.play, this.edit, save, load, file);
    notebook.onChange(() => { this.show(); });
    this.show();
  }

  choose(right: number, up: number): void {
    const { pointing, settings, notebook } = this.shop;
    const pointed = pointing.at(right, up, settings.snaps, this.ending.signal);
    if (pointed === null) return;
    const { point } = pointed.shown;
    notebook.add({ notes: [{ at: point, text: words.notes.one(String(notebook.notes.length + 1)) }], bookmarks: [] });
    this.list.querySelector<HTMLTextAreaElement>('li:last-child textarea')?.select();
    pointed.original.then((original) => { if (original) this.move(point, original); }, () => undefined);
  }

  undo(): boolean {
    const { notebook } = this.shop;
    if (notebook.notes.length === 0) return false;
    this.remove(notebook.notes[notebook.notes.length - 1]);
    return true;
  }

  marks(): readonly Mark[] {
    return this.shop.notebook.notes.map(({ at, text }) => ({ at: this.places.toLocal(at), text: text.slice(0, MOST_MARK) }));
  }

  close(): void {
    this.ending.abort();
  }

  private move(from: Note['at'], { point }: PickedPoint): void {
    this.replace((note) => (note.at === from ? { ...note, at: point } : note));
  }

  private replace(change: (note: Note, i: number) => Note): void {
    const { notebook } = this.shop;
    notebook.notes = notebook.notes.map(change);
    notebook.changed();
  }

  private remove(gone: Note): void {
    const { notebook } = this.shop;
    notebook.notes = notebook.notes.filter((note) => note !== gone);
    notebook.changed();
  }

  /// By its number: the note itself is another one after each change.
  private ordersOf(i: number): NoteOrders {
    const { notebook } = this.shop;
    return {
      change: (change) => { this.replace((note, k) => (k === i ? { ...note, ...change } : note)); },
      seen: () => this.seen(),
      go: () => { this.flyTo(notebook.notes[i]); },
      remove: () => { this.remove(notebook.notes[i]); },
      up: i === 0 ? null : () => { this.swap(i - 1, i); },
      down: i === notebook.notes.length - 1 ? null : () => { this.swap(i, i + 1); },
      failed: (message) => { this.note.textContent = message; },
    };
  }

  private swap(i: number, k: number): void {
    const { notes } = this.shop.notebook;
    this.opened = this.opened === i ? k : this.opened === k ? i : this.opened;
    this.replace((_, at) => notes[at === i ? k : at === k ? i : at]);
  }

  private seen(): SeenFrom {
    const { bench } = this.shop;
    const { position, target } = bench.pose();
    return { position: this.places.toInput(position), target: this.places.toInput(target), choices: bench.choices() };
  }

  private tell(): void {
    const { title, notes, bookmarks } = this.shop.notebook;
    this.shop.story.play({ title, notes, bookmarks }, 0);
  }

  private flyTo(note: Note): void {
    const { bench } = this.shop;
    const { min, max } = bench.view.box;
    bench.fly(poseOfNote(note, this.places, bench.pose(), CLOSER * min.distanceTo(max)));
  }

  /// Rows that somebody writes in stay as they are.
  private show(): void {
    const { notebook, bench, story } = this.shop;
    const isWriting = document.activeElement instanceof HTMLTextAreaElement && this.list.contains(document.activeElement) && this.list.childElementCount === notebook.notes.length;
    if (!isWriting) this.list.replaceChildren(...notebook.notes.map((note, i) => this.rowOf(note, i)));
    this.title.value = notebook.title;
    for (const part of [this.titleRow, this.play]) part.hidden = notebook.notes.length === 0;
    this.edit.hidden = notebook.notes.length > 0 || story.told === null;
    this.note.textContent = notebook.isInLink ? '' : words.notes.tooLong;
    bench.redraw();
  }

  private rowOf(note: Note, i: number): HTMLElement {
    const opened = (open: boolean): void => { this.opened = open ? i : this.opened === i ? null : this.opened; };
    return noteRow(note, words.notes.one(String(i + 1)), this.ordersOf(i), this.opened === i, opened);
  }

  private async load(file: HTMLInputElement): Promise<void> {
    const [given] = file.files ?? [];
    file.value = '';
    if (given === undefined) return;
    try {
      const { leftOut = 0, ...notebook } = readNotes(await given.text(), [language]);
      this.shop.notebook.add(notebook);
      if (leftOut > 0) this.note.textContent = pageWords.story.leftOut(leftOut, formatCount(leftOut));
    } catch (problem) {
      this.note.textContent = words.notes.bad(given.name, problem instanceof Error ? problem.message : String(problem));
    }
  }
}

export function makeTool(shop: Workshop): Tool {
  return new NotesTool(shop);
}
