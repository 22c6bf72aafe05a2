// SPDX-License-Identifier: MIT
// Draws frames while there is something new, and none otherwise.

const POLL = 250; // milliseconds, while something is awaited that draws nothing yet

/// `busy`: the next frame will be another one. `waiting`: something may come.
export type Pace = 'busy' | 'waiting' | 'rest';

export class FrameLoop {
  private frame = 0;
  private timer = 0;
  private stopped = false;

  /// `draw`: a frame; tells what is to be expected next.
  constructor(private readonly draw: (now: number) => Pace) {}

  /// A frame, soon.
  readonly wake = (): void => {
    window.clearTimeout(this.timer);
    if (this.frame === 0 && !this.stopped) this.frame = requestAnimationFrame((now) => { this.tick(now); });
  };

  stop(): void {
    this.stopped = true;
    cancelAnimationFrame(this.frame);
    window.clearTimeout(this.timer);
  }

  private tick(now: number): void {
    this.frame = 0;
    const pace = this.draw(now);
    if (pace === 'busy') this.wake();
    else if (pace === 'waiting' && this.frame === 0) this.timer = window.setTimeout(this.wake, POLL);
  }
}
