// SPDX-License-Identifier: MIT
// Says what a tool still does though its card is closed, and ends it.
import { element, icon } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import type { Tool } from './tool.js';
import { words } from './words/words.js';

export class LastingSign {
  readonly root: HTMLButtonElement;
  private readonly text = element('span', {});
  private tool: Tool | null = null;

  /// `surface`: has the focus once it is ended.
  constructor(surface: HTMLElement) {
    this.root = element('button', { type: 'button', class: 'tool-lasting', hidden: true }, this.text, icon(ICONS.close));
    this.root.addEventListener('click', () => {
      surface.focus();
      this.tool?.end?.();
    });
  }

  show(tool: Tool | null): void {
    const text = tool?.lasting?.() ?? '';
    this.tool = tool;
    this.root.hidden = tool === null;
    if (this.text.textContent === text) return;
    this.text.textContent = text;
    this.root.title = words.end(text);
    this.root.setAttribute('aria-label', words.end(text));
  }
}
