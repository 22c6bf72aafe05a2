// SPDX-License-Identifier: MIT
// The finest level that is shown.
import type { Manifest } from '../../src/index.js';
import { slider, type Control } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { words } from '../words/words.js';

export class LevelForm {
  readonly root = element('div', { hidden: true });
  private control: Control<number> | null = null;
  private last = 0;
  private level: number | null = null;

  /// `chosen`: null: all levels.
  constructor(private readonly chosen: (level: number | null) => void) {}

  /// The model has these levels: from 0 on, as many as halve its partitions.
  tell({ partitions }: Manifest): void {
    const last = Math.ceil(Math.log2(partitions));
    if (last === this.last) return;
    this.last = last;
    this.control = slider(words.settings.level, '', { least: 0, most: last, step: 1 }, (level) => { this.chosen(level < last ? Math.round(level) : null); });
    this.root.replaceChildren(this.control.root);
    this.root.hidden = false;
    this.show(this.level);
  }

  show(level: number | null): void {
    this.level = level;
    this.control?.show(Math.min(level ?? this.last, this.last));
  }
}
