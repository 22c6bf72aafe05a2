// SPDX-License-Identifier: MIT
// Notes at points of the surface, with files of them.
import { formatNotes, readNotes, type Note } from '../../src/tools/notes.js';
import type { PickedPoint } from '../../src/tools/picked_point.js';
import { element } from '../parts/element.js';
import { CameraPose } from '../view/camera_pose.js';
import { download } from './download.js';
import { entryList, type Entry } from './entry_list.js';
import { textButton } from './figures.js';
import type { Mark } from './overlay.js';
import { Places } from './places.js';
import type { Tool } from './tool.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

const CLOSER = 0.25; // of the model's size: from there a note is looked at
const MOST_MARK = 40; // letters beside a point

export class NotesTool implements Tool {
  readonly root: HTMLElement;
  private readonly list = element('ul', { class: 'tool-list' });
  private readonly note = element('p', { class: 'tool-note', 'aria-live': 'polite' });
  private readonly places: Places;
  private readonly ending = new AbortController();

  constructor(private readonly shop: Workshop) {
    const { bench, notebook } = shop;
    this.places = new Places(bench.view);
    const file = element('input', { type: 'file', accept: '.json,application/json', class: 'tool-file', tabindex: '-1', 'aria-hidden': 'true' });
    file.addEventListener('change', () => void this.load(file));
    const save = textButton(words.notes.save, () => { download(new Blob([formatNotes(notebook, bench.name)], { type: 'application/json' }), `${bench.name}-notes.json`); });
    const load = textButton(words.notes.load, () => { file.click(); });
    for (const button of [save, load]) button.classList.add('tool-extra');
    this.root = element('div', {}, element('p', { class: 'tool-note' }, words.notes.hint), this.list, this.note, save, load, file);
    notebook.onChange(() => { this.show(); });
    this.show();
  }

  choose(right: number, up: number): void {
    const { pointing, settings, notebook } = this.shop;
    const pointed = pointing.at(right, up, settings.snaps, this.ending.signal);
    if (pointed === null) return;
    const { point } = pointed.shown;
    notebook.add({ notes: [{ at: point, text: words.notes.one(String(notebook.notes.length + 1)) }], bookmarks: [] });
    this.list.querySelector<HTMLInputElement>('li:last-child input')?.select();
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
  private entryOf({ text }: Note, i: number): Entry {
    const { notebook } = this.shop;
    return {
      text,
      rename: (changed) => { this.replace((note, k) => (k === i ? { ...note, text: changed } : note)); },
      go: () => { this.flyTo(notebook.notes[i]); },
      remove: () => { this.remove(notebook.notes[i]); },
    };
  }

  /// Along the way that the camera looks.
  private flyTo({ at }: Note): void {
    const { bench } = this.shop;
    const target = this.places.toWorld(at);
    const size = bench.view.box.min.distanceTo(bench.view.box.max);
    bench.fly(new CameraPose(target.clone().addScaledVector(bench.pose().forward, -Math.min(bench.pose().distance, CLOSER * size)), target));
  }

  /// Rows that somebody writes in stay as they are.
  private show(): void {
    const { notebook, bench } = this.shop;
    const isWriting = this.list.contains(document.activeElement) && this.list.childElementCount === notebook.notes.length;
    if (!isWriting) this.list.replaceChildren(...entryList(notebook.notes.map((note, i) => this.entryOf(note, i)), words.notes.one));
    this.note.textContent = notebook.isInLink ? '' : words.notes.tooLong;
    bench.redraw();
  }

  private async load(file: HTMLInputElement): Promise<void> {
    const [given] = file.files ?? [];
    file.value = '';
    if (given === undefined) return;
    try {
      this.shop.notebook.add(readNotes(await given.text()));
    } catch (problem) {
      this.note.textContent = words.notes.bad(given.name, problem instanceof Error ? problem.message : String(problem));
    }
  }
}

export function makeTool(shop: Workshop): Tool {
  return new NotesTool(shop);
}
