// Names the mode in force.
import type { Mode } from '../../src/scene/settings.js';
import { element } from './element.js';

export type ShownMode = Mode | 'TP';

const NAMES: Record<ShownMode, string> = {
  TP: 'thumbnail preview',
  CWV: 'coarse whole view',
  ZSV: 'zoomed sector view',
  DZM: 'deep zoom of the mesh',
};

export class ModeBadge {
  private readonly short = element('b', {});
  private readonly long = element('span', {});
  readonly root = element('p', { class: 'badge', 'aria-live': 'polite', 'aria-atomic': 'true' }, this.short, ' ', this.long);
  private shown: ShownMode | null = null;

  show(mode: ShownMode): void {
    if (mode === this.shown) return;
    this.shown = mode;
    this.root.dataset.mode = mode;
    this.short.textContent = mode;
    this.long.textContent = NAMES[mode];
  }
}
