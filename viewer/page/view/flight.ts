// SPDX-License-Identifier: MIT
// A way from one pose to another, in time.
import type { CameraPose } from '../../src/scene/camera_pose.js';
import { between } from './camera_moves.js';
import { SmoothPath } from './smooth_path.js';

const MILLISECONDS = 650;

function eased(t: number): number {
  return t * t * (3 - 2 * t);
}

export class Flight {
  private start: number | null = null;

  private constructor(
    readonly milliseconds: number,
    private readonly to: CameraPose,
    private readonly way: (t: number) => CameraPose,
  ) {}

  /// Straight there.
  static straight(from: CameraPose, to: CameraPose): Flight {
    return new Flight(MILLISECONDS, to, (t) => between(from, to, t));
  }

  /// So that one sees how the places lie to each other; the farther, the longer.
  static overview(from: CameraPose, to: CameraPose): Flight {
    const path = new SmoothPath(from, to);
    return new Flight(path.milliseconds, to, (t) => path.at(t));
  }

  /// Where it is at a time of the browser's frames; it starts with the first one.
  at(now: number): { pose: CameraPose; done: boolean } {
    this.start ??= now;
    const t = (now - this.start) / this.milliseconds;
    return t >= 1 ? { pose: this.to, done: true } : { pose: this.way(eased(Math.max(t, 0))), done: false };
  }
}
