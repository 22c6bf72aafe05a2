// SPDX-License-Identifier: MIT
// How many vertices the frame rate asked for allows (Zunino et al.: the detail follows the measured rate).

/// Intervals are averaged over as long as this, and over three frames at least; very slow ones over two. The longest
/// is left out: a frame in which tiles arrive is no measure of the next. One that is slower still is acted on at once, but
/// with care.
const WINDOW_MS = 120;
const LEAST_FRAMES = 3;
const TOO_SLOW = 4; // frames of the rate asked for
const FAR_TOO_SLOW = 12;
const MOST_SHRINK = 4;
/// Frames after a change of the budget that may still show what was before.
const SETTLE_FRAMES = 1;
/// No change while a frame takes as little more, and as little less, than it may: no oscillation.
const TOLERANCE = 0.06;
const SPARE = 0.12;
/// So much to spare is another situation.
const MUCH_SPARE = 0.5;
/// A single step's largest growth.
const MOST_GROWTH = 1.6;
const LEAST_BUDGET = 256;
const MOST_BUDGET = 50_000_000;
/// If vertices take less than this part of a frame, less of them is no help: the pixels are what takes the time.
const LEAST_PART = 0.15;
/// It is another situation if a frame takes this much longer than it did then.
const CHANGED = 1.4;
/// At the display's own rate a faster device looks like one that is just fast enough: so now and then a little more is tried.
const PROBE_GROWTH = 1.15;
/// A step up that was too much (one tile may be) is not tried again for a while, longer each time.
const FIRST_WAIT_MS = 1000;
const LAST_WAIT_MS = 60_000;

interface Measured {
  readonly vertices: number;
  readonly milliseconds: number;
}

export class FrameRate {
  budget = 2_000_000;
  /// The rate of the last window; 0: nothing is measured yet.
  framesPerSecond = 0;
  private intervals: number[] = [];
  private elapsed = 0;
  private skip = 0;
  private sinceChange = 0;
  private wait = 0;
  private wentUp = false;
  /// The time of a frame before the last step down, and where a step down turned out to be of no use.
  private before: Measured | null = null;
  private floor: Measured | null = null;

  constructor(public target: number) {}

  /// The camera began to move: the frames since it last did say nothing.
  restart(): void {
    this.clear();
  }

  /// A frame that shows `vertices` took `interval` milliseconds. `limited`: more would be shown if the budget allowed.
  frame(interval: number, vertices: number, limited: boolean): void {
    if (this.skip > 0) {
      --this.skip;
      return;
    }
    this.intervals.push(interval);
    this.elapsed += interval;
    this.sinceChange += interval;
    const count = this.intervals.length;
    const enough = count >= LEAST_FRAMES && this.elapsed >= WINDOW_MS;
    const frames = (this.elapsed * this.target) / 1000;
    if (enough || (count === 2 && frames > 2 * TOO_SLOW)) this.judge(vertices, limited);
    else if (count === 1 && frames > FAR_TOO_SLOW) this.change(Math.min(this.budget, vertices) / MOST_SHRINK, false);
  }

  private judge(vertices: number, limited: boolean): void {
    const count = this.intervals.length;
    const milliseconds = (this.elapsed - Math.max(...this.intervals)) / (count - 1);
    const ratio = (milliseconds * this.target) / 1000;
    this.framesPerSecond = 1000 / Math.max(milliseconds, 0.1);
    this.intervals = [];
    this.elapsed = 0;
    if (ratio > 1 + TOLERANCE) this.shrink({ vertices, milliseconds }, ratio);
    else if (limited) this.grow(ratio);
  }

  private shrink(now: Measured, ratio: number): void {
    if (this.wentUp) this.wait = Math.min(Math.max(2 * this.wait, FIRST_WAIT_MS), LAST_WAIT_MS);
    if (this.wasOfNoUse(now)) this.floor = this.before;
    else if (this.floor !== null && now.milliseconds > CHANGED * this.floor.milliseconds) this.floor = null;
    this.before = now;
    this.change(Math.max(this.floor?.vertices ?? 0, Math.min(this.budget, now.vertices) / ratio), false);
  }

  /// Tells whether the last step down saved hardly anything.
  private wasOfNoUse({ vertices, milliseconds }: Measured): boolean {
    if (this.before === null || vertices > 0.9 * this.before.vertices) return false;
    const perVertex = (this.before.milliseconds - milliseconds) / (this.before.vertices - vertices);
    return perVertex * this.before.vertices < LEAST_PART * this.before.milliseconds;
  }

  /// The vertices that are shown come in tiles: only the budget itself grows by little.
  private grow(ratio: number): void {
    this.before = null;
    if (ratio < MUCH_SPARE) this.wait = 0;
    const isSpare = ratio < 1 - SPARE;
    if (this.sinceChange < Math.max(this.wait, isSpare ? 0 : FIRST_WAIT_MS)) return;
    this.change(this.budget * (isSpare ? Math.min(MOST_GROWTH, 1 / ratio) : PROBE_GROWTH), true);
  }

  private change(budget: number, wentUp: boolean): void {
    this.budget = Math.round(Math.min(MOST_BUDGET, Math.max(LEAST_BUDGET, budget)));
    this.clear();
    this.wentUp = wentUp;
    this.skip = SETTLE_FRAMES;
  }

  private clear(): void {
    this.intervals = [];
    this.elapsed = 0;
    this.sinceChange = 0;
  }
}
