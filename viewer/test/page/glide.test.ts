// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { zoomOfSpread } from '../../page/view/gestures.js';
import { Glide } from '../../page/view/glide.js';

describe('a glide', () => {
  it('gives all that was put in, bit by bit, and ends', () => {
    const glide = new Glide();
    glide.add({ turnRight: 1, zoom: -0.5 });
    glide.add({ turnRight: 1 });
    let [turned, zoomed, frames] = [0, 0, 0];
    for (; glide.busy; ++frames) {
      const moves = glide.take(16, false);
      turned += moves.turnRight;
      zoomed += moves.zoom;
    }
    expect(turned).toBeCloseTo(2, 12);
    expect(zoomed).toBeCloseTo(-0.5, 12);
    expect(frames).toBeGreaterThan(10);
    expect(frames).toBeLessThan(100);
  });

  it('may give all at once', () => {
    const glide = new Glide();
    glide.add({ panUp: 0.3 });
    expect(glide.take(16, true).panUp).toBe(0.3);
    expect(glide.busy).toBe(false);
  });

  it.each([NaN, Infinity, -Infinity])('takes no part of %d', (zoom) => {
    const glide = new Glide();
    glide.add({ zoom: 0.25, panUp: 1 });
    glide.add({ zoom, panUp: zoom });
    glide.add({ zoom: -zoom });
    expect(glide.take(16, true)).toMatchObject({ zoom: 0.25, panUp: 1 });
    expect(glide.busy).toBe(false);
  });

  it('can be stopped', () => {
    const glide = new Glide();
    glide.add({ panUp: 0.3 });
    glide.clear();
    expect(glide.busy).toBe(false);
  });
});

describe('a pinch', () => {
  it('is a factor, and none where the fingers meet or part', () => {
    expect(zoomOfSpread(100, 200)).toBeCloseTo(-Math.log(2), 12);
    expect(zoomOfSpread(100, 0)).toBe(0);
    expect(zoomOfSpread(0, 100)).toBe(0);
    expect(zoomOfSpread(0, 0)).toBe(0);
  });
});
