// SPDX-License-Identifier: MIT
// Names the mode in force.
import type { Mode } from '../../src/scene/settings.js';
import { words } from '../words/words.js';
import { element } from './element.js';

export class ModeBadge {
  readonly root = element('p', { class: 'badge', 'aria-live': 'polite', 'aria-atomic': 'true' });

  show(mode: Mode): void {
    if (mode === this.root.dataset.mode) return;
    this.root.dataset.mode = mode;
    this.root.textContent = words.modes[mode];
  }
}
