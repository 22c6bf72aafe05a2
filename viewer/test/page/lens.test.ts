// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { VIEW_ANGLE } from '../../page/view/camera_moves.js';
import { Lens } from '../../page/view/lens.js';

describe('Lens', () => {
  it('waits until the model is drawn', () => {
    const lens = new Lens();
    expect([lens.step(5000, false), lens.isUsual]).toEqual([false, false]);
    expect(lens.angle).toBeLessThan(0.02);
  });

  it('widens, and then stays', () => {
    const lens = new Lens();
    const angles = [100, 300, 500, 599, 600].map((now) => {
      expect(lens.step(now, true)).toBe(true);
      return lens.angle;
    });
    expect(angles).toEqual([...angles].sort((a, b) => a - b));
    expect([lens.angle, lens.isUsual, lens.step(700, true)]).toEqual([VIEW_ANGLE, true, false]);
  });

  it('is as usual at once where it is ended', () => {
    const lens = new Lens();
    lens.end();
    expect([lens.angle, lens.step(0, true)]).toEqual([VIEW_ANGLE, false]);
  });
});
