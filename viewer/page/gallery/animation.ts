// SPDX-License-Identifier: MIT
// Turns what is pointed at or focused, a frame after the other while there is something to turn.

const RADIANS_A_MILLISECOND = 0.00035;
const LONGEST_STEP = 100; // milliseconds

const still = matchMedia('(prefers-reduced-motion: reduce)');

export interface Turnable {
  /// By an angle, by itself; draws it.
  advance(angle: number): void;
}

export class Animation {
  private readonly turning = new Set<Turnable>();
  private frame = 0;
  private before = 0;

  constructor() {
    still.addEventListener('change', () => { this.ask(); });
  }

  start(one: Turnable): void {
    this.turning.add(one);
    this.ask();
  }

  stop(one: Turnable): void {
    this.turning.delete(one);
  }

  stopAll(): void {
    this.turning.clear();
  }

  private ask(): void {
    if (this.frame !== 0 || this.turning.size === 0 || still.matches) return;
    this.frame = requestAnimationFrame((now) => { this.turn(now); });
  }

  private turn(now: number): void {
    this.frame = 0;
    const angle = Math.min(now - this.before, LONGEST_STEP) * RADIANS_A_MILLISECOND;
    this.before = now;
    for (const one of this.turning) one.advance(angle);
    this.ask();
  }
}
