// SPDX-License-Identifier: MIT
// The place of a model that is not known yet: it asks for it when it is near the window.
import { element } from '../parts/element.js';
import type { Cell } from './cell.js';

export class SlotCell implements Cell {
  readonly root: HTMLLIElement = element('li', { 'aria-busy': 'true' }, element('div', { class: 'cell cell-slot' }, element('span', { class: 'cell-stage waiting' })));

  constructor(readonly load: () => void) {}

  redraw(): void {
    // it is as the style has it
  }

  close(): void {
    this.root.remove();
  }
}
