// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { Sharpness } from '../../page/view/sharpness.js';

/// The last of so many moving frames with that many milliseconds between them.
function move(sharpness: Sharpness, frames: number, interval: number, start = 0): number {
  let last = 1;
  for (let i = 0; i < frames; ++i) last = sharpness.at(start + i * interval, true, 30);
  return last;
}

describe('sharpness', () => {
  it('is whole where the frame rate is held', () => {
    expect(move(new Sharpness(), 50, 33)).toBe(1);
  });

  it('goes down to a half where it is not, and no further', () => {
    expect(move(new Sharpness(), 100, 120)).toBe(0.5);
  });

  it('is whole at rest, and remembers', () => {
    const sharpness = new Sharpness();
    move(sharpness, 100, 120);
    expect(sharpness.at(12000, false, 30)).toBe(0.5);
    expect(sharpness.at(12300, false, 30)).toBe(1);
    expect(sharpness.blurred).toBe(false);
    expect(sharpness.at(13000, true, 30)).toBe(0.5);
  });

  it('comes back where there is time left', () => {
    const sharpness = new Sharpness();
    move(sharpness, 100, 120);
    expect(move(sharpness, 50, 10, 12010)).toBe(1);
  });
});
