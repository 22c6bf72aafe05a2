// SPDX-License-Identifier: MIT
import { beforeEach, describe, expect, it, vi } from 'vitest';
import type { Moves } from '../../page/view/glide.js';
import { Gestures } from '../../page/view/gestures.js';

/// 400 x 200 pixels, 10 from the left and 20 from the top.
class FakeSurface extends EventTarget {
  readonly clientHeight = 200;
  readonly focus = vi.fn();
  readonly setPointerCapture = vi.fn();
  getBoundingClientRect(): object {
    return { left: 10, top: 20, width: 400, height: 200 };
  }
}

class FakeNavigation {
  readonly grab = vi.fn<(right: number, up: number) => void>();
  readonly grabMiddle = vi.fn();
  readonly approach = vi.fn<(right: number, up: number) => void>();
  readonly move = vi.fn<(moves: Partial<Moves>) => void>();
}

let surface = new FakeSurface();
let navigation = new FakeNavigation();

function send(type: string, pointerId: number, clientX: number, clientY: number): void {
  surface.dispatchEvent(Object.assign(new Event(type), { pointerId, clientX, clientY, button: 0, shiftKey: false }));
}

/// Returns what the last movement had.
function moved(): string[] {
  return Object.keys(navigation.move.mock.lastCall?.[0] ?? {});
}

function pinch(): void {
  send('pointerdown', 1, 100, 100);
  send('pointerdown', 2, 200, 100);
  send('pointermove', 2, 220, 100);
}

beforeEach(() => {
  [surface, navigation] = [new FakeSurface(), new FakeNavigation()];
  new Gestures(surface as unknown as HTMLElement, navigation);
});

describe('a gesture', () => {
  it('turns with one finger', () => {
    send('pointerdown', 1, 100, 100);
    send('pointermove', 1, 120, 90);
    expect(moved()).toEqual(['turnRight', 'turnUp']);
  });

  it('moves and zooms with two, where their middle is', () => {
    pinch();
    expect(navigation.grab.mock.lastCall).toEqual([((150 - 10) / 400) * 2 - 1, 1 - ((100 - 20) / 200) * 2]);
    expect(moved()).toEqual(['panRight', 'panUp', 'zoom']);
  });

  it.each(['pointerup', 'pointercancel'])('of two ends with the %s of one: the other turns', (end) => {
    pinch();
    send(end, 2, 220, 100);
    send('pointermove', 1, 110, 100);
    expect(moved()).toEqual(['turnRight', 'turnUp']);
    expect(navigation.grabMiddle).toHaveBeenCalledTimes(2);
  });

  it('flies to where it taps twice', () => {
    for (const type of ['pointerdown', 'pointerup', 'pointerdown', 'pointerup']) send(type, 1, 210, 70);
    expect(navigation.approach.mock.calls).toEqual([[0, 0.5]]);
  });

  it('does not tap when it is cancelled', () => {
    for (const type of ['pointerdown', 'pointercancel', 'pointerdown', 'pointercancel']) send(type, 1, 210, 70);
    expect(navigation.approach).not.toHaveBeenCalled();
  });
});
