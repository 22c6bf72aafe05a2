// SPDX-License-Identifier: MIT
// Turns a model once in a while, as long as it is on.

const SECONDS = 24; // a turn
const LONGEST_FRAME = 100; // milliseconds; after a longer one it goes on slowly
/// Where less motion is asked for: at once, and then nothing.
export const STEP = Math.PI / 6;

export class Turntable {
  private before: number | null = null;

  get isOn(): boolean {
    return this.before !== null;
  }

  start(now: number): void {
    this.before = now;
  }

  stop(): void {
    this.before = null;
  }

  /// Radians since it was last asked; `now` in milliseconds.
  take(now: number): number {
    if (this.before === null) return 0;
    const passed = Math.min(Math.max(now - this.before, 0), LONGEST_FRAME);
    this.before = now;
    return (passed / 1000 / SECONDS) * 2 * Math.PI;
  }
}
