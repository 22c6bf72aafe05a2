// How many vertices the frame rate asked for allows (Zunino et al.: the detail follows the measured rate).

/// Intervals are averaged over as long as this, and over two frames at least.
const WINDOW_MS = 120;
/// Frames after a change of the budget that may still show what was before.
const SETTLE_FRAMES = 1;
/// No change while the rate is as close as this to the one asked for: no oscillation.
const TOLERANCE = 0.06;
/// A single step's largest growth, and how far over the time asked for one frame is enough to act.
const MOST_GROWTH = 1.6;
const TOO_SLOW = 2;
const LEAST_BUDGET = 4096;
const MOST_BUDGET = 50_000_000;
/// At the display's own rate a faster device looks like one that is just fast enough: so now and then a little more is tried,
/// less often each time it was too much.
const PROBE_GROWTH = 1.15;
const FIRST_PROBE_MS = 1000;
const LAST_PROBE_MS = 60_000;

export class FrameRate {
  budget = 2_000_000;
  /// Of the last window; 0: nothing measured yet.
  framesPerSecond = 0;
  private elapsed = 0;
  private frames = 0;
  private skip = 0;
  private sinceChange = 0;
  private probeAfter = FIRST_PROBE_MS;
  private isProbing = false;

  constructor(public target: number) {}

  /// The camera began to move: nothing that was measured before counts.
  restart(): void {
    this.clear();
  }

  /// A frame that shows `vertices` took `interval` milliseconds. `limited`: more would be shown if the budget allowed.
  frame(interval: number, vertices: number, limited: boolean): void {
    if (this.skip > 0) {
      --this.skip;
      return;
    }
    this.elapsed += interval;
    this.sinceChange += interval;
    ++this.frames;
    const enough = this.frames >= 2 && this.elapsed >= WINDOW_MS;
    if (enough || interval > (TOO_SLOW * 1000) / this.target) this.judge(vertices, limited);
  }

  private judge(vertices: number, limited: boolean): void {
    const mean = this.elapsed / this.frames;
    const ratio = (mean * this.target) / 1000;
    this.framesPerSecond = 1000 / mean;
    this.elapsed = 0;
    this.frames = 0;
    if (ratio > 1 + TOLERANCE) this.shrink(vertices, ratio);
    else if (ratio < 1 - TOLERANCE) this.grow(limited, Math.min(MOST_GROWTH, 1 / ratio));
    else this.probe(limited);
  }

  private shrink(vertices: number, ratio: number): void {
    if (this.isProbing) this.probeAfter = Math.min(2 * this.probeAfter, LAST_PROBE_MS);
    this.change(Math.min(this.budget, vertices) / ratio);
  }

  /// What is shown comes in tiles: only the budget itself grows by little.
  private grow(limited: boolean, factor: number): void {
    if (limited) this.change(this.budget * factor);
  }

  private probe(limited: boolean): void {
    if (!limited || this.sinceChange < this.probeAfter) return;
    this.change(this.budget * PROBE_GROWTH);
    this.isProbing = true;
  }

  private change(budget: number): void {
    this.budget = Math.round(Math.min(MOST_BUDGET, Math.max(LEAST_BUDGET, budget)));
    this.clear();
    this.skip = SETTLE_FRAMES;
  }

  private clear(): void {
    this.elapsed = 0;
    this.frames = 0;
    this.sinceChange = 0;
    this.isProbing = false;
  }
}
