// SPDX-License-Identifier: MIT
// About a model: its source, licence and sizes.
import type { Manifest } from '../../src/index.js';
import type { Model } from '../listing.js';
import { element } from '../parts/element.js';
import { factsOf } from './facts.js';

export class InfoSheet {
  readonly root = element('dl', { class: 'figures info' });
  private shown: Manifest | null = null;

  show(model: Model, manifest: Manifest): void {
    if (manifest === this.shown) return;
    this.shown = manifest;
    const rows = factsOf(model, manifest).map(([name, text]) => element('div', {}, element('dt', {}, name), element('dd', {}, text)));
    this.root.replaceChildren(...rows);
  }
}
