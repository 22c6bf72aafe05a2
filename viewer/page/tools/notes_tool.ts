// SPDX-License-Identifier: MIT
// Notes at points of the surface, and the story that they tell in their order; with files of them.
import { formatNotes, readNotes } from '../../src/tools/notes.js';
import { element } from '../parts/element.js';
import { download } from './download.js';
import { textButton } from './figures.js';
import { NoteList } from './note_list.js';
import type { Mark } from '../../src/plugins/overlay.js';
import type { Tool } from './tool.js';
import { formatCount } from '../numbers.js';
import { language, words as pageWords } from '../words/words.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

const MOST_MARK = 40; // letters beside a point
const MOST_TITLE = 200; // letters

export class NotesTool implements Tool {
  readonly root: HTMLElement;
  private readonly list: NoteList;
  private readonly title = element('input', { type: 'text', class: 'tool-text', maxlength: String(MOST_TITLE) });
  private readonly titleRow = element('label', { class: 'tool-field tool-extra' }, words.notes.title, this.title);
  private readonly play = textButton(words.notes.play, () => { this.tell(); });
  private readonly edit = textButton(words.notes.edit, () => { this.shop.notebook.add(this.shop.story.told!); });
  private readonly ending = new AbortController();

  constructor(private readonly shop: Workshop) {
    const { bench, notebook } = shop;
    this.list = new NoteList(shop);
    const file = element('input', { type: 'file', accept: '.json,application/json', class: 'tool-file', tabindex: '-1', 'aria-hidden': 'true' });
    file.addEventListener('change', () => void this.load(file));
    const save = textButton(words.notes.save, () => { download(new Blob([formatNotes(notebook, bench.name)], { type: 'application/json' }), `${bench.fileName}.story.json`); });
    const load = textButton(words.notes.load, () => { file.click(); });
    for (const button of [save, load]) button.classList.add('tool-extra');
    this.title.addEventListener('change', () => {
      notebook.title = this.title.value.trim();
      notebook.changed();
    });
    this.root = element('div', {}, element('p', { class: 'tool-note' }, words.notes.hint), this.titleRow, this.list.root, this.list.message, this.play, this.edit, save, load, file);
    notebook.onChange(() => { this.show(); });
    this.show();
  }

  choose(right: number, up: number): void {
    const { pointing, settings, notebook } = this.shop;
    const pointed = pointing.at(right, up, settings.snaps, this.ending.signal);
    if (pointed === null) return;
    const { point } = pointed.shown;
    notebook.add({ notes: [{ at: point, text: words.notes.one(String(notebook.notes.length + 1)) }], bookmarks: [] });
    this.list.root.querySelector<HTMLTextAreaElement>('li:last-child textarea')?.select();
    pointed.original.then((original) => { if (original) notebook.moveNote(point, original.point); }, () => undefined);
  }

  undo(): boolean {
    const { notebook } = this.shop;
    if (notebook.notes.length === 0) return false;
    this.list.remove(notebook.notes.length - 1);
    return true;
  }

  marks(): readonly Mark[] {
    const { notebook, places } = this.shop;
    return notebook.notes.map(({ at, text }) => ({ at: places.toLocal(at), text: text.slice(0, MOST_MARK) }));
  }

  close(): void {
    this.ending.abort();
  }

  private tell(): void {
    const { title, notes, bookmarks } = this.shop.notebook;
    this.shop.story.play({ title, notes, bookmarks }, 0);
  }

  private show(): void {
    const { notebook, bench, story } = this.shop;
    this.list.show();
    this.title.value = notebook.title;
    for (const part of [this.titleRow, this.play]) part.hidden = notebook.notes.length === 0;
    this.edit.hidden = notebook.notes.length > 0 || story.told === null;
    this.list.message.textContent = notebook.isInLink ? '' : words.notes.tooLong;
    bench.redraw();
  }

  private async load(file: HTMLInputElement): Promise<void> {
    const [given] = file.files ?? [];
    file.value = '';
    if (given === undefined) return;
    try {
      const { leftOut = 0, ...notebook } = readNotes(await given.text(), [language]);
      this.shop.notebook.add(notebook);
      if (leftOut > 0) this.list.message.textContent = pageWords.story.leftOut(leftOut, formatCount(leftOut));
    } catch (problem) {
      this.list.message.textContent = words.notes.bad(given.name, problem instanceof Error ? problem.message : String(problem));
    }
  }
}

export function makeTool(shop: Workshop): Tool {
  return new NotesTool(shop);
}
