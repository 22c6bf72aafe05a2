// SPDX-License-Identifier: MIT
// A text that is to be pasted elsewhere, with a button that copies it.
import { copyText } from '../parts/clipboard.js';
import { element } from '../parts/element.js';
import { words } from '../words/words.js';

const TOLD = 2500; // milliseconds that a success is told

async function copy(field: HTMLTextAreaElement): Promise<boolean> {
  const isCopied = await copyText(field.value);
  if (!isCopied) field.select(); // the user copies what is selected
  return isCopied;
}

export class CopyField {
  readonly root: HTMLElement;
  readonly field: HTMLTextAreaElement;
  private readonly button = element('button', { type: 'button', class: 'text-button' }, words.share.copy);
  private timer = 0;

  /// `status`: says that it was copied.
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
