// SPDX-License-Identifier: MIT
import { Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { CameraPose } from '../../src/scene/camera_pose.js';
import { SmoothPath } from '../../page/view/smooth_path.js';

function pose(position: readonly [number, number, number], target: readonly [number, number, number] = [0, 0, 0]): CameraPose {
  return new CameraPose(new Vector3(...position), new Vector3(...target));
}

const STEPS = Array.from({ length: 101 }, (_, i) => i / 100);

describe('a smooth path', () => {
  it.each([
    ['to another place', pose([0, 0, 1]), pose([9, 0, 1], [9, 0, 0])],
    ['closer', pose([0, 0, 10]), pose([0, 0, 0.01])],
    ['around', pose([0, 0, 1]), pose([0, 0, -1])],
    ['with all of it', pose([1, 2, 3]), pose([-50, 20, 7], [-51, 20, 7])],
    ['nowhere', pose([1, 2, 3]), pose([1, 2, 3])],
  ])('%s goes from the one to the other without a jump', (_, from, to) => {
    const path = new SmoothPath(from, to);
    expect(path.at(0)).toBe(from);
    expect(path.at(1)).toBe(to);
    expect(path.at(1e-9).position.distanceTo(from.position)).toBeLessThan(1e-6 * (1 + from.distance));
    expect(path.at(1 - 1e-9).position.distanceTo(to.position)).toBeLessThan(1e-5 * (1 + to.distance));
    const places = STEPS.map((t) => path.at(t));
    // Seen from the camera no step is a jump: neither the target nor the distance.
    places.slice(1).forEach((place, i) => {
      const near = Math.min(place.distance, places[i].distance);
      expect(place.target.distanceTo(places[i].target)).toBeLessThan(0.25 * near);
      expect(Math.abs(Math.log(place.distance / places[i].distance))).toBeLessThan(0.25);
    });
  });

  it('draws back on a long way, and not on a short one', () => {
    const far = new SmoothPath(pose([0, 0, 1]), pose([100, 0, 1], [100, 0, 0]));
    expect(far.at(0.5).distance).toBeGreaterThan(20);
    const near = new SmoothPath(pose([0, 0, 1]), pose([0.1, 0, 1], [0.1, 0, 0]));
    expect(near.at(0.5).distance).toBeLessThan(1.01);
  });

  it('turns the shorter way, upright', () => {
    const path = new SmoothPath(pose([Math.sin(3), 0, Math.cos(3)]), pose([Math.sin(-3), 0, Math.cos(-3)]));
    expect(path.at(0.5).position.z).toBeCloseTo(-1, 6);
    for (const t of STEPS) expect(Math.abs(path.at(t).position.y)).toBeLessThan(1e-12);
  });

  it('takes longer for more, and never too long', () => {
    const short = new SmoothPath(pose([0, 0, 1]), pose([0, 0, 0.9])).milliseconds;
    const long = new SmoothPath(pose([0, 0, 1]), pose([3, 0, 1], [3, 0, 0])).milliseconds;
    const longest = new SmoothPath(pose([0, 0, 1e-6]), pose([1e6, 0, 1e-6], [1e6, 0, 0])).milliseconds;
    expect(short).toBe(650);
    expect(long).toBeGreaterThan(short);
    expect(longest).toBe(4000);
  });
});
