// SPDX-License-Identifier: MIT
/// Calls once when the earliest of the times that were asked for has come.
export class Alarm {
  private timer: ReturnType<typeof setTimeout> | null = null;
  private due = Infinity;

  constructor(private readonly ring: () => void) {}

  /// In so many milliseconds, unless it rings before.
  in(milliseconds: number): void {
    const due = performance.now() + milliseconds;
    if (!(due < this.due)) return;
    this.stop();
    this.due = due;
    this.timer = setTimeout(() => {
      this.stop();
      this.ring();
    }, milliseconds);
  }

  stop(): void {
    if (this.timer !== null) clearTimeout(this.timer);
    this.timer = null;
    this.due = Infinity;
  }
}
