// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { checkedPose } from '../../page/hook.js';

describe('a camera that a script sets', () => {
  it('is taken as it is', () => {
    const pose = { position: [1, 2, 3], target: [1, 2, 3.5] };
    expect(checkedPose(pose)).toBe(pose);
  });

  it.each([
    ['looks from where it looks at', { position: [1, 2, 3], target: [1, 2, 3] }, 'the same point'],
    ['does so but for digits that links drop', { position: [1, 0, 0], target: [1 + 1e-14, 0, 0] }, 'the same point'],
    ['is nowhere', { position: [NaN, 2, 3], target: [0, 0, 0] }, 'finite'],
    ['looks at infinity', { position: [1, 2, 3], target: [0, Infinity, 0] }, 'finite'],
    ['is too far away to tell how far', { position: [1e200, 0, 0], target: [0, 0, 0] }, 'too far'],
    ['is there beside what it looks at', { position: [1e300, 1, 0], target: [1e300, 0, 0] }, 'too far'],
    ['has two numbers', { position: [1, 2], target: [0, 0, 0] }, 'three'],
    ['has texts', { position: ['1', 2, 3], target: [0, 0, 0] }, 'three'],
    ['has no target', { position: [1, 2, 3] }, 'three'],
    ['is none', null, 'three'],
  ])('is refused if it %s', (_, pose, why) => {
    expect(() => checkedPose(pose)).toThrow(RangeError);
    expect(() => checkedPose(pose)).toThrow(why);
  });
});
