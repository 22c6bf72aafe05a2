// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { directionOf, readFirstView } from '../../src/hierarchy/first_view.js';

function refuse(): never {
  throw new Error('no view');
}

describe('a first view', () => {
  it('is what the extras say', () => {
    expect(readFirstView({ extras: { firstView: [101.25, -13] } }, refuse)).toEqual({ azimuth: 101.25, elevation: -13 });
    expect(readFirstView({}, refuse)).toBeNull();
  });

  it.each([null, 1, 'x', {}, { firstView: null }, { firstView: [1] }, { firstView: [1, 2, 3] }, { firstView: [361, 0] }, { firstView: [0, 91] }, { firstView: ['1', 2] }])('is refused as %j', (extras) => {
    expect(() => readFirstView({ extras }, refuse)).toThrow('no view');
  });

  it('is a direction of length 1, never straight up', () => {
    for (const [azimuth, elevation] of [[0, 0], [90, 45], [-360, -90], [10, 90]]) {
      const [x, y, z] = directionOf({ azimuth, elevation });
      expect(Math.hypot(x, y, z)).toBeCloseTo(1);
      expect(Math.hypot(x, z)).toBeGreaterThan(0.005);
    }
    const [x, y, z] = directionOf({ azimuth: 90, elevation: 0 });
    expect([x, y, z]).toEqual([1, expect.closeTo(0), expect.closeTo(0)]);
  });
});
