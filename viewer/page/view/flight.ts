// SPDX-License-Identifier: MIT
// A way from one pose to another.
import { between, type CameraPose } from './camera_pose.js';

const MILLISECONDS = 650;

function eased(t: number): number {
  return t * t * (3 - 2 * t);
}

export class Flight {
  private start: number | null = null;

  constructor(
    private readonly from: CameraPose,
    private readonly to: CameraPose,
  ) {}

  /// Where it is at a time of the browser's frames; it starts with the first one.
  at(now: number): { pose: CameraPose; done: boolean } {
    this.start ??= now;
    const t = (now - this.start) / MILLISECONDS;
    return t >= 1 ? { pose: this.to, done: true } : { pose: between(this.from, this.to, eased(Math.max(t, 0))), done: false };
  }
}
