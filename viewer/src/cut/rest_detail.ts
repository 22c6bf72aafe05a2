// SPDX-License-Identifier: MIT
// When a still view asks for more detail than a moving one: first for as much as was asked for, then, whenever that is there, for
// twice as much.

/// So long a step must have been complete: who only pauses fetches nothing for it.
export const PAUSE_MS = 300;

export class RestDetail {
  private divisor = 1;
  private completeSince: number | null = null;

  /// The error that was asked for is divided by it; `finest` at the most.
  step(now: number, atRest: boolean, finest: number): number {
    const isDue = this.completeSince !== null && now - this.completeSince >= PAUSE_MS;
    if (!atRest) this.divisor = 1;
    else if (isDue) this.divisor = Math.min(2 * this.divisor, finest);
    if (!atRest || isDue) this.completeSince = null;
    return Math.min(this.divisor, finest);
  }

  /// Tells whether all of the step is there.
  saw(now: number, isComplete: boolean): void {
    if (!isComplete) this.completeSince = null;
    else this.completeSince ??= now;
  }
}
