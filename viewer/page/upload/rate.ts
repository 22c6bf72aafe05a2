// SPDX-License-Identifier: MIT
// How quickly something goes on: over the last seconds, as it may become slower.

const WINDOW = 5000; // milliseconds

export class RateMeter {
  private readonly seen: { time: number; amount: number }[] = [];

  /// `time` in milliseconds; neither goes back.
  note(time: number, amount: number): void {
    this.seen.push({ time, amount });
    while (this.seen.length > 2 && this.seen[1].time <= time - WINDOW) this.seen.shift();
  }

  /// A second; null as long as it cannot be told.
  get rate(): number | null {
    const first = this.seen.at(0);
    const last = this.seen.at(-1);
    if (first === undefined || last === undefined || last.time === first.time) return null;
    return (1000 * (last.amount - first.amount)) / (last.time - first.time);
  }

  /// Seconds until `total` is reached; null if that cannot be told.
  secondsTo(total: number): number | null {
    const { rate } = this;
    return rate === null || rate <= 0 ? null : (total - this.seen.at(-1)!.amount) / rate;
  }
}
