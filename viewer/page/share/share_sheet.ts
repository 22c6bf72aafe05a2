// SPDX-License-Identifier: MIT
// A link to what is shown, and the code for other pages; each with a button that copies it.
import { copyText } from '../parts/clipboard.js';
import { element } from '../parts/element.js';
import { words } from '../words/words.js';
import type { ViewParts } from '../view/view_parts.js';
import { elementCode, frameCode } from './embed_code.js';

const TOLD = 2500; // milliseconds that a success is told

async function copy(field: HTMLTextAreaElement): Promise<boolean> {
  const isCopied = await copyText(field.value);
  if (!isCopied) field.select(); // the user copies what is selected
  return isCopied;
}

class CopyField {
  readonly root: HTMLElement;
  readonly field: HTMLTextAreaElement;
  private readonly button = element('button', { type: 'button', class: 'text-button' }, words.share.copy);
  private timer = 0;

  constructor(name: string, rows: number, private readonly status: HTMLElement) {
    this.field = element('textarea', { class: 'code', rows: String(rows), readonly: true, spellcheck: 'false', 'aria-label': name });
    this.root = element('div', { class: 'copy-field' }, element('div', { class: 'copy-head' }, element('span', {}, name), this.button), this.field);
    this.button.addEventListener('click', () => { void this.copy(); });
    this.field.addEventListener('focus', () => { this.field.select(); });
  }

  private async copy(): Promise<void> {
    const done = await copy(this.field);
    this.status.textContent = done ? words.share.copied : words.share.selected;
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => { this.status.textContent = ''; }, TOLD);
  }
}

export class ShareSheet {
  readonly root: HTMLElement;
  private readonly status = element('p', { class: 'copy-status', role: 'status' });
  private readonly link = new CopyField(words.share.link, 2, this.status);
  private readonly frame = new CopyField(words.share.frame, 4, this.status);
  private readonly element = new CopyField(words.share.element, 4, this.status);

  private readonly codes = element('div', { class: 'share' }, this.frame.root, this.element.root, element('p', { class: 'hint' }, words.share.elementHint));

  constructor(private readonly parts: ViewParts) {
    this.root = element('div', { class: 'share' }, this.link.root, this.codes, this.status);
  }

  /// Takes what is seen now: the page's address tells of it once the view was asked.
  show(): void {
    const shared = this.parts.shared();
    this.link.field.value = location.href;
    this.codes.hidden = shared.isWhole;
    this.frame.field.value = frameCode(shared);
    this.element.field.value = elementCode(shared);
  }
}
