// SPDX-License-Identifier: MIT
// Keeps what is still to be moved of a gesture: each frame takes its part, so that movements end softly.

const SETTLING = 70; // milliseconds until a third is left
const LEAST = 1e-4; // of a radian, of the picture's height, of a factor's logarithm

/// Radians, parts of the picture's height, the logarithm of a factor.
export interface Moves {
  turnRight: number;
  turnUp: number;
  panRight: number;
  panUp: number;
  zoom: number;
}

const KEYS = ['turnRight', 'turnUp', 'panRight', 'panUp', 'zoom'] as const;

function noMoves(): Moves {
  return { turnRight: 0, turnUp: 0, panRight: 0, panUp: 0, zoom: 0 };
}

export class Glide {
  private readonly left = noMoves();

  get busy(): boolean {
    return KEYS.some((key) => this.left[key] !== 0);
  }

  /// A number that is not finite is no movement.
  add(moves: Partial<Moves>): void {
    for (const key of KEYS) {
      const move = moves[key] ?? 0;
      if (Number.isFinite(move)) this.left[key] += move;
    }
  }

  clear(): void {
    Object.assign(this.left, noMoves());
  }

  /// The part for a frame that long after the last one; all of what is left if it is little or `atOnce`.
  take(milliseconds: number, atOnce: boolean): Moves {
    const part = atOnce ? 1 : 1 - Math.exp(-milliseconds / SETTLING);
    const taken = noMoves();
    for (const key of KEYS) {
      const left = this.left[key];
      taken[key] = Math.abs(left) < LEAST ? left : left * part;
      this.left[key] = left - taken[key];
    }
    return taken;
  }
}
