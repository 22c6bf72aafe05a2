// SPDX-License-Identifier: MIT
// A model first stands as its hierarchy's picture has it, without perspective, which then comes: nothing jumps when the one takes the place of
// the other. All the while the model is framed as with the first camera.
import { VIEW_ANGLE } from './camera_moves.js';

const LONG = Math.PI / 180; // radians: as good as without perspective
const DURATION = 500; // milliseconds

export class Lens {
  /// Null: it has not begun.
  private began: number | null = null;
  private passed = 0;

  /// The part of perspective that is there, from 0 to 1.
  private get part(): number {
    return this.passed * this.passed * (3 - 2 * this.passed);
  }

  get isUsual(): boolean {
    return this.passed >= 1;
  }

  /// Radians, from the lower to the upper edge of the picture.
  get angle(): number {
    const [long, usual] = [Math.tan(LONG / 2), Math.tan(VIEW_ANGLE / 2)];
    return 2 * Math.atan(long + (usual - long) * this.part);
  }

  /// `isDrawn`: the model is in the picture's place. True: it is another one than in the frame before.
  step(now: number, isDrawn: boolean): boolean {
    if (!isDrawn || this.isUsual) return false;
    this.began ??= now;
    this.passed = Math.min((now - this.began) / DURATION, 1);
    return true;
  }

  end(): void {
    this.passed = 1;
  }
}
