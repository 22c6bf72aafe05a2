// SPDX-License-Identifier: MIT
// Takes files that are dropped onto the gallery or chosen, and sends them one upload after the other.
import './upload.css';
import type { UploadOffer } from '../listing.js';
import { formatBytes } from '../numbers.js';
import { element } from '../parts/element.js';
import type { Problems } from '../problems.js';
import { words } from '../words/words.js';
import { droppedFiles, listedFiles } from './chosen_files.js';
import { plan, type Chosen, type Upload } from './plan.js';
import { refusalText, send, type ServerAnswer } from './send.js';
import { Token } from './token.js';
import { UploadRow } from './upload_row.js';

const CREATED = 201;
const UNAUTHORIZED = 401;

interface Waiting {
  row: UploadRow;
  ending: AbortController;
}

/// Event `stored`, at its root and above: the server has taken something.
export class Uploader {
  readonly root: HTMLElement;
  private readonly rows = element('ul', { class: 'upload-rows', 'aria-label': words.upload.title });
  private readonly token = new Token();
  private readonly queue: Waiting[] = [];
  private readonly told = new Map<string, () => void>(); // problems, and what takes each away
  private busy = false;
  private offer: UploadOffer | null = null;

  /// `place`: it is marked while files are held over the page, and takes none while it is hidden. `inbox`: its address, with a slash at its end.
  constructor(private readonly place: HTMLElement, private readonly problems: Problems, private readonly inbox: string) {
    this.root = element('section', { class: 'upload', hidden: true },
      element('div', { class: 'upload-buttons' }, this.picker(words.upload.addFiles, false), this.picker(words.upload.addFolder, true),
        element('span', { class: 'upload-hint' }, words.upload.hint)),
      this.rows);
    this.watchDrops();
    window.addEventListener('beforeunload', (event) => { if (this.queue.length > 0) event.preventDefault(); });
  }

  /// Null: the server takes nothing.
  show(offer: UploadOffer | null): void {
    this.offer = offer;
    this.root.hidden = offer === null;
  }

  add(chosen: readonly Chosen[]): void {
    if (this.offer === null || chosen.length === 0) return;
    this.forgetProblems();
    const { uploads, problems } = plan(chosen, this.offer.limit, formatBytes(this.offer.limit));
    for (const problem of problems) this.tell(problem);
    for (const upload of uploads) this.enqueue(upload);
    void this.work();
  }

  private enqueue(upload: Upload): void {
    const ending = new AbortController();
    const row = new UploadRow(upload, () => { ending.abort(); });
    const waiting = { row, ending };
    ending.signal.addEventListener('abort', () => { this.drop(waiting); });
    this.rows.append(row.root);
    this.queue.push(waiting);
  }

  /// A button that opens the browser's own choice of files.
  private picker(name: string, folder: boolean): HTMLElement {
    const input = element('input', { type: 'file', hidden: true, multiple: true, webkitdirectory: folder, 'aria-label': name });
    input.addEventListener('change', () => {
      this.add(listedFiles(input.files!));
      input.value = ''; // the same ones may be chosen again
    });
    const button = element('button', { type: 'button', class: 'button upload-text' }, name);
    button.addEventListener('click', () => { input.click(); });
    return element('span', { class: folder ? 'upload-folder' : null }, button, input);
  }

  /// Anywhere on the page while the gallery is shown: beside it the browser would leave the page for the file.
  private watchDrops(): void {
    const { place } = this;
    const takes = ({ dataTransfer }: DragEvent): boolean =>
      this.offer !== null && !place.hidden && (dataTransfer?.types.includes('Files') ?? false);
    const mark = (on: boolean): void => { place.classList.toggle('upload-target', on); };
    window.addEventListener('dragover', (event) => {
      if (!takes(event)) return;
      event.preventDefault();
      mark(true);
    });
    window.addEventListener('dragleave', ({ relatedTarget }) => { if (relatedTarget === null) mark(false); });
    window.addEventListener('drop', (event) => {
      mark(false);
      if (!takes(event)) return;
      event.preventDefault();
      droppedFiles(event.dataTransfer!).then((files) => { this.add(files); }, () => { this.tell(words.upload.unreadable); });
    });
  }

  private drop(waiting: Waiting): void {
    waiting.row.root.remove();
    const place = this.queue.indexOf(waiting);
    if (place >= 0) this.queue.splice(place, 1);
  }

  private async work(): Promise<void> {
    if (this.busy) return;
    this.busy = true;
    for (let next = this.queue.at(0); next !== undefined; next = this.queue.at(0)) {
      const answer = await this.sendOne(next);
      this.drop(next);
      if (answer === null) continue;
      if (answer.status === CREATED) this.root.dispatchEvent(new Event('stored', { bubbles: true }));
      else this.tell(refusalText(next.row.upload.name, answer));
    }
    this.busy = false;
  }

  /// Null if it was ended. A wrong token is asked for again; who tells none ends all.
  private async sendOne(waiting: Waiting): Promise<ServerAnswer | null> {
    for (;;) {
      const token = this.offer?.token === true ? await this.token.get() : null;
      if (this.offer?.token === true && token === null) {
        for (const each of [...this.queue]) each.ending.abort();
        return null;
      }
      const answer = await this.sendWith(token, waiting);
      if (answer?.status !== UNAUTHORIZED || token === null) return answer;
      this.token.forget();
    }
  }

  private sendWith(token: string | null, { row, ending }: Waiting): Promise<ServerAnswer | null> {
    const told = (sent: number, total: number): void => { row.show(sent, total, performance.now()); };
    told(0, row.upload.bytes);
    return send(row.upload, { inbox: this.inbox, token, told, ended: ending.signal });
  }

  private tell(problem: string): void {
    this.told.set(problem, this.problems.tell(problem));
  }

  /// Those of an earlier try: what was dismissed then would not be told again.
  private forgetProblems(): void {
    for (const takeAway of this.told.values()) takeAway();
    this.told.clear();
  }
}
