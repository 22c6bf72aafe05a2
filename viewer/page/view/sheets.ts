// SPDX-License-Identifier: MIT
// Sheets open beside the picture, or over its lower part where it is narrow: one at a time there.
import { element, iconButton } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { words } from '../words/words.js';

const narrow = matchMedia('(max-width: 719px)');

export class Sheet {
  readonly root: HTMLElement;
  readonly button: HTMLButtonElement;
  /// Told of each opening and closing.
  changed: (open: boolean) => void = () => undefined;

  /// `key`: of its style, the same in all languages.
  constructor(
    key: string,
    readonly name: string,
    drawing: string,
    content: readonly HTMLElement[],
  ) {
    const id = `sheet-${key}`;
    const close = iconButton(words.parts.close(name), ICONS.close, () => { this.close(); });
    const head = element('div', { class: 'sheet-head' }, element('h2', {}, name), close);
    this.root = element('section', { class: `sheet ${id}`, id, 'aria-label': name, hidden: true }, head, element('div', { class: 'sheet-body' }, ...content));
    this.button = iconButton(name, drawing, () => { this.toggle(); });
    this.button.setAttribute('aria-controls', id);
    this.button.setAttribute('aria-expanded', 'false');
  }

  get isOpen(): boolean {
    return !this.root.hidden;
  }

  toggle(): void {
    if (this.isOpen) this.close();
    else this.open();
  }

  open(): void {
    this.set(true);
  }

  /// The focus goes back to the button if it was inside.
  close(): void {
    const inside = this.root.contains(document.activeElement);
    this.set(false);
    if (inside) this.button.focus();
  }

  private set(open: boolean): void {
    if (open === this.isOpen) return;
    this.root.hidden = !open;
    this.button.setAttribute('aria-expanded', String(open));
    this.changed(open);
  }
}

export class Sheets {
  /// `aside`: of them only one is open; the others may stay beside it where there is room.
  constructor(
    private readonly all: readonly Sheet[],
    private readonly aside: readonly Sheet[],
    changed: (sheet: Sheet, open: boolean) => void,
    signal: AbortSignal,
  ) {
    for (const sheet of all) {
      sheet.changed = (open) => {
        if (open) this.makeRoom(sheet);
        changed(sheet, open);
      };
    }
    narrow.addEventListener('change', () => { this.keepOne(); }, { signal });
  }

  get anyOpen(): boolean {
    return this.all.some(({ isOpen }) => isOpen);
  }

  /// The one opened for reading or choosing. False: none is.
  closeAside(): boolean {
    const open = this.aside.find(({ isOpen }) => isOpen);
    open?.close();
    return open !== undefined;
  }

  /// Any of them. False: none is open.
  closeOne(): boolean {
    const open = this.all.find(({ isOpen }) => isOpen);
    open?.close();
    return open !== undefined;
  }

  private makeRoom(opened: Sheet): void {
    const others = narrow.matches ? this.all : this.aside.includes(opened) ? this.aside : [];
    for (const sheet of others) if (sheet !== opened) sheet.close();
  }

  private keepOne(): void {
    const open = this.all.filter(({ isOpen }) => isOpen);
    if (narrow.matches) for (const sheet of open.slice(1)) sheet.close();
  }
}
