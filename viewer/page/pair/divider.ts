// SPDX-License-Identifier: MIT
// The line between two models in a swipe: dragged by hand, moved by arrows.
import { element } from '../parts/element.js';
import { words } from '../words/words.js';

const STEP = 0.02;
const LARGE_STEP = 0.1;
const STEPS: Readonly<Record<string, number>> = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 };

export class Divider {
  readonly root = element('div', { class: 'pair-divider', role: 'slider', tabindex: '0', 'aria-orientation': 'horizontal', 'aria-valuemin': '0', 'aria-valuemax': '100', 'aria-label': words.pair.divider });
  private at = 0.5;

  /// `picture`: the line goes from its left edge to its right one. `moved`: to this part of its width.
  constructor(private readonly picture: HTMLElement, private readonly moved: (part: number) => void) {
    this.root.append(element('span', { class: 'pair-grip', 'aria-hidden': 'true' }));
    this.root.addEventListener('pointerdown', (event) => {
      event.preventDefault();
      this.root.setPointerCapture(event.pointerId);
      this.root.focus({ preventScroll: true });
    });
    this.root.addEventListener('pointermove', (event) => { if (this.root.hasPointerCapture(event.pointerId)) this.drag(event); });
    this.root.addEventListener('keydown', (event) => { this.key(event); });
  }

  show(part: number): void {
    this.at = part;
    this.root.style.left = `${100 * part}%`;
    this.root.setAttribute('aria-valuenow', String(Math.round(100 * part)));
  }

  /// By so many small steps.
  step(count: number): void {
    this.move(this.at + count * STEP);
  }

  private move(part: number): void {
    this.moved(Math.min(Math.max(part, 0), 1));
  }

  private drag({ clientX }: PointerEvent): void {
    const { left, width } = this.picture.getBoundingClientRect();
    this.move((clientX - left) / width);
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const ends: Readonly<Record<string, number>> = { Home: 0, End: 1 };
    if (event.key in STEPS) this.move(this.at + STEPS[event.key] * (event.shiftKey ? LARGE_STEP : STEP));
    else if (event.key in ends) this.move(ends[event.key]);
    else return;
    event.preventDefault();
    event.stopPropagation(); // the camera's arrows
  }
}
