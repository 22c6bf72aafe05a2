// SPDX-License-Identifier: MIT
// Shows one model and then the other, by itself: not where less motion is asked for.

const PAUSE = 900; // milliseconds: slower than what may harm, quick enough to see what differs

const still = matchMedia('(prefers-reduced-motion: reduce)');

export class Blinking {
  isOn = !still.matches;
  private timer = 0;
  private isSeen = false;

  constructor(private readonly turn: () => void) {}

  get isAllowed(): boolean {
    return !still.matches;
  }

  set(on: boolean): void {
    this.isOn = on && this.isAllowed;
    this.begin(this.isSeen);
  }

  /// `isSeen`: models are looked at so.
  begin(isSeen: boolean): void {
    const runs = isSeen && this.isOn && this.isAllowed;
    this.isSeen = isSeen;
    window.clearInterval(this.timer);
    this.timer = runs ? window.setInterval(() => { if (!document.hidden) this.turn(); }, PAUSE) : 0;
  }
}
