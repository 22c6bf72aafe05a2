// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { PAUSE_MS, RestDetail } from '../src/cut/rest_detail.js';

/// The divisor of each frame; of each: whether the view is at rest, and whether what it asks for is there.
function divisors(frames: readonly (readonly [boolean, boolean])[], finest: number, interval = PAUSE_MS): number[] {
  const detail = new RestDetail();
  return frames.map(([atRest, isComplete], i) => {
    const divisor = detail.step(i * interval, atRest, finest);
    detail.saw(i * interval, isComplete);
    return divisor;
  });
}

function times<Value>(count: number, value: Value): Value[] {
  return Array<Value>(count).fill(value);
}

describe('RestDetail', () => {
  it('doubles when all has been there for a while, up to the finest', () => {
    expect(divisors(times(6, [true, true]), 4)).toEqual([1, 2, 4, 4, 4, 4]);
    expect(divisors(times(4, [true, true]), 3)).toEqual([1, 2, 3, 3]);
    expect(divisors(times(4, [true, true]), 1)).toEqual([1, 1, 1, 1]);
  });

  it('waits for what is missing', () => {
    expect(divisors([...times(3, [true, false] as const), ...times(3, [true, true] as const)], 4)).toEqual([1, 1, 1, 1, 2, 4]);
  });

  it('asks for no more in a short pause', () => {
    expect(divisors(times(6, [true, true]), 4, PAUSE_MS / 2)).toEqual([1, 1, 2, 2, 4, 4]);
  });

  it('begins anew after a movement', () => {
    expect(divisors([...times(3, [true, true] as const), [false, false], ...times(3, [true, true] as const)], 4)).toEqual([1, 2, 4, 1, 1, 2, 4]);
  });
});
