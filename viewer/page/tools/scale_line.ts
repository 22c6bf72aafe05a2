// SPDX-License-Identifier: MIT
// The scale bar below the picture.
import { isParallel } from '../../src/scene/projection.js';
import { scaleBar, unitsPerPixel } from '../../src/tools/scale_bar.js';
import { element } from '../parts/element.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

const MOST_PIXELS = 140;

export class ScaleLine {
  readonly root = element('div', { class: 'scale-line', role: 'img', hidden: true });

  constructor(private readonly shop: Workshop) {}

  /// Shows the scale for the camera as it is.
  show(): void {
    const { bench } = this.shop;
    const isEverywhere = isParallel(bench.camera);
    const perPixel = unitsPerPixel(isEverywhere ? 1 : bench.pose().distance, bench.camera.projectionMatrix.elements[5], bench.surface.clientHeight);
    const bar = scaleBar(perPixel, MOST_PIXELS, this.shop.scale);
    this.root.hidden = bar === null;
    if (bar === null) return;
    this.root.style.width = `${bar.pixels}px`;
    const label = isEverywhere ? words.scaleEverywhere(bar.text) : words.scale(bar.text);
    if (this.root.getAttribute('aria-label') === label) return;
    this.root.textContent = bar.text;
    this.root.setAttribute('aria-label', label);
  }
}
