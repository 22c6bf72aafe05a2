// SPDX-License-Identifier: MIT
// From which sides a model is looked at, in upright coordinates: y up, the front towards z.
import type { Vector } from './vectors.js';

export type Side = 'front' | 'back' | 'left' | 'right' | 'top' | 'bottom';

export const SIDES: Readonly<Record<Side, Vector>> = {
  front: [0, 0, 1],
  back: [0, 0, -1],
  left: [-1, 0, 0],
  right: [1, 0, 0],
  top: [0, 1, 0],
  bottom: [0, -1, 0],
};

/// Straight from above nobody knows which way is up: so much aside, in radians.
const ASIDE = 0.01;

/// Where the camera stands that sees a side, `distance` away from its target. `isExact`: not aside, as drawings want it: the front is below.
export function positionFor(side: Side, target: Vector, distance: number, isExact = false): Vector {
  const [x, y, z] = SIDES[side];
  const angle = isExact ? 0 : ASIDE;
  const aside = y === 0 ? z : Math.sin(angle);
  const up = y * Math.cos(angle);
  return [target[0] + distance * x, target[1] + distance * up, target[2] + distance * aside];
}

/// The rotation of a camera (16 numbers of its inverse world matrix, by columns) for a cube of CSS, whose y goes down.
export function cubeTransform(inverse: ArrayLike<number>): string {
  const sign = (row: number, column: number): number => ((row === 1) === (column === 1) ? 1 : -1);
  const numbers = Array.from({ length: 16 }, (_, i) => {
    const [column, row] = [Math.floor(i / 4), i % 4];
    if (column === 3 || row === 3) return row === column ? 1 : 0;
    return Number((sign(row, column) * inverse[i]).toFixed(6));
  });
  return `matrix3d(${numbers.join(',')})`;
}
