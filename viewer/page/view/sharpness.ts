// SPDX-License-Identifier: MIT
// Fewer pixels while the camera moves, where the frame rate cannot be held otherwise; all of them at rest.

const LEAST = 0.5;
const STEP = 0.75;
const SLOW = 1.5; // times the frame's time that was asked for
const FAST = 0.6;
const FRAMES = 4; // looked at before a change
const REST = 220; // milliseconds without movement
const LONGEST_FRAME = 1000; // milliseconds; a longer one was no frame

export class Sharpness {
  private moving = 1;
  private now = 1;
  private before = 0;
  private movedAt = -Infinity;
  private readonly intervals: number[] = [];

  /// Less than all pixels are drawn at the moment.
  get blurred(): boolean {
    return this.now < 1;
  }

  /// The part of the pixels on each axis for a frame.
  at(time: number, moved: boolean, framesPerSecond: number): number {
    const interval = time - this.before;
    const wentOn = time - this.movedAt < REST;
    this.before = time;
    if (moved) this.movedAt = time;
    if (moved && wentOn && interval < LONGEST_FRAME) this.learn(interval, 1000 / framesPerSecond);
    this.now = moved || time - this.movedAt < REST ? this.moving : 1;
    return this.now;
  }

  private learn(interval: number, wanted: number): void {
    this.intervals.push(interval);
    if (this.intervals.length < FRAMES) return;
    const mean = this.intervals.reduce((sum, one) => sum + one, 0) / this.intervals.length;
    this.intervals.length = 0;
    if (mean > SLOW * wanted) this.moving = Math.max(this.moving * STEP, LEAST);
    else if (mean < FAST * wanted) this.moving = Math.min(this.moving / STEP, 1);
  }
}
