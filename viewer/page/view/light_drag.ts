// SPDX-License-Identifier: MIT
// While L is held, or once it is chosen, a drag turns the light; L alone opens the settings.
import type { Angles } from '../../src/scene/lighting.js';

const KEY = 'l';

export class LightDrag {
  /// As if L were held: for those who have no keys.
  isChosen = false;
  private held = false;
  private used = false;

  /// `tapped`: L was pressed and nothing was dragged. Until `signal` aborts.
  constructor(
    private readonly turn: (by: Angles) => void,
    private readonly tapped: () => void,
    signal: AbortSignal,
  ) {
    window.addEventListener('keyup', (event) => { this.lift(event); }, { signal });
    window.addEventListener('blur', () => { this.held = false; }, { signal });
  }

  /// L went down.
  hold(): void {
    if (!this.held) this.used = false;
    this.held = true;
  }

  /// Radians of a drag. False: it is none of the light.
  drag(right: number, up: number): boolean {
    if (!this.held && !this.isChosen) return false;
    if (!Number.isFinite(right + up)) return true; // of a picture without a size
    this.used = true;
    this.turn({ right, up });
    return true;
  }

  private lift({ key }: KeyboardEvent): void {
    if (!this.held || key.toLowerCase() !== KEY) return;
    this.held = false;
    if (!this.used) this.tapped();
  }
}
