// SPDX-License-Identifier: MIT
import { Box3, Vector3 } from 'three';
import { beforeAll, describe, expect, it, vi } from 'vitest';
import { CameraPose } from '../../src/scene/camera_pose.js';
import type { Navigation } from '../../page/view/navigation.js';

/// Frames until it rests, and longer than any flight takes.
function fly(navigation: Navigation): void {
  for (let now = 0; now < 10_000; now += 50) {
    navigation.step(now);
    expect([...navigation.pose.position, ...navigation.pose.target].every(Number.isFinite)).toBe(true);
  }
}

describe('the camera', () => {
  let make: () => Navigation;

  beforeAll(async () => {
    vi.stubGlobal('matchMedia', () => ({ matches: false }));
    const { Navigation } = await import('../../page/view/navigation.js');
    make = () => new Navigation(() => null, () => undefined);
  });

  it.each([[1e300, 0.25], [1e155, 0.25], [1e30, 1], [Infinity, 1], [NaN, 1], [0, 0]])('stays at numbers, wherever it is sent to: %s, beside that %s', (far, beside) => {
    const there = new CameraPose(new Vector3(far, beside, 0), new Vector3(far, 0, 0));
    for (const go of ['travel', 'fly', 'jump'] as const) {
      const navigation = make();
      navigation[go](there);
      fly(navigation);
      navigation.move({ turnRight: 1, zoom: -1, panUp: 1 });
      fly(navigation);
      const home = new CameraPose(new Vector3(0, 0, 3), new Vector3(0, 0, 0));
      navigation.travel(home);
      fly(navigation);
      expect(navigation.pose.target.length()).toBeLessThan(1);
    }
  });

  it('goes from the first view to all of the model and back, but to the first view where that is asked for', () => {
    const navigation = make();
    const first = new CameraPose(new Vector3(3, 2, 1), new Vector3());
    navigation.frame(new Box3(new Vector3(-1, -1, -1), new Vector3(1, 1, 1)), { aspect: 1, direction: null, first });
    const shown = [() => { navigation.goHomeOrOut(); }, () => { navigation.goHome(); }, () => { navigation.goHome(); }, () => { navigation.goHomeOrOut(); }, () => { navigation.goHomeOrOut(); }].map((go) => {
      go();
      fly(navigation);
      return navigation.pose.equals(first);
    });
    expect(shown).toEqual([false, true, true, false, true]);
  });
});
