// SPDX-License-Identifier: MIT
// A list of names and values in a card, each of which can be copied in full: with all its digits, as programs read it.
import { copyText } from '../parts/clipboard.js';
import { element, icon } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { words } from './words/words.js';

/// A line of a card; `copied`: in full.
export interface Figure {
  readonly name: string;
  readonly shown: string;
  readonly copied: string;
  /// The address that it leads to.
  readonly link?: string | null;
}

/// `copied`: a number of which all digits are copied.
export function line(name: string, shown: string, copied: string | number = shown): Figure {
  return { name, shown, copied: Object.is(copied, -0) ? '-0' : String(copied) };
}

function valueOf({ shown, copied, link }: Figure): HTMLElement {
  const title = copied === shown ? null : copied;
  if (typeof link === 'string') return element('a', { class: 'object-value', href: link, target: '_blank', rel: 'noopener noreferrer' }, shown);
  return element('span', { class: 'object-value', dir: 'auto', title }, shown);
}

/// The buttons that copy are one stop of the tab key: arrows lead from one to the next.
export class FigureList {
  readonly root: HTMLElement;
  private readonly list: HTMLElement;
  private readonly said = element('p', { class: 'tool-note', role: 'status' });
  private lines: readonly Figure[] = [];
  private buttons: readonly HTMLButtonElement[] = [];

  /// `isLive`: lines are told to those who hear the page when they change.
  constructor(isLive = true) {
    this.list = element('dl', { class: 'figures tool-figures object-figures', 'aria-live': isLive ? 'polite' : null });
    this.list.addEventListener('keydown', (event) => { this.keyed(event); });
    this.root = element('div', {}, this.list, this.said);
  }

  /// A line with the same name as before stays, and keeps the focus.
  show(lines: readonly Figure[]): void {
    if (JSON.stringify(lines) === JSON.stringify(this.lines)) return;
    this.said.textContent = '';
    const had = this.buttons.findIndex((button) => button === document.activeElement);
    const name = this.lines[had]?.name;
    this.lines = lines;
    this.buttons = lines.map((each) => this.copyButton(each));
    this.list.replaceChildren(...lines.map((each, i) => element('div', {}, element('dt', { dir: 'auto' }, each.name), element('dd', {}, valueOf(each), this.buttons[i]))));
    const at = Math.max(lines.findIndex((each) => each.name === name), 0);
    if (lines.length === 0) return;
    this.buttons[at].tabIndex = 0;
    if (had >= 0) this.buttons[at].focus();
  }

  private copyButton(each: Figure): HTMLButtonElement {
    const button = element('button', { type: 'button', class: 'object-copy', 'aria-label': words.objects.copy(each.name), title: words.objects.copy(each.name), tabindex: '-1' }, icon(ICONS.copy));
    button.addEventListener('click', () => void this.copy(each));
    return button;
  }

  private async copy({ name, copied }: Figure): Promise<void> {
    const said = (await copyText(copied)) ? words.pick.copied : words.pick.notCopied;
    this.said.textContent = `${name}: ${said}`;
  }

  private keyed(event: KeyboardEvent): void {
    const { buttons } = this;
    const at = buttons.findIndex((button) => button === event.target);
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (at < 0 || step === undefined) return;
    const to = buttons[Math.min(Math.max(at + step, 0), buttons.length - 1)];
    buttons[at].tabIndex = -1;
    to.tabIndex = 0;
    to.focus();
    event.preventDefault();
    event.stopPropagation();
  }
}

export function textButton(name: string, act: () => void): HTMLButtonElement {
  const button = element('button', { type: 'button', class: 'text-button' }, name);
  button.addEventListener('click', act);
  return button;
}
