// SPDX-License-Identifier: MIT
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { LightDrag } from '../../page/view/light_drag.js';

const page = new EventTarget();
let ending = new AbortController();
beforeEach(() => { vi.stubGlobal('window', page); ending = new AbortController(); });
afterEach(() => { ending.abort(); vi.unstubAllGlobals(); });

function lift(key: string): void {
  page.dispatchEvent(Object.assign(new Event('keyup'), { key }));
}

function made(): { drag: LightDrag; turn: ReturnType<typeof vi.fn>; tapped: ReturnType<typeof vi.fn> } {
  const [turn, tapped] = [vi.fn(), vi.fn()];
  return { drag: new LightDrag(turn, tapped, ending.signal), turn, tapped };
}

describe('L', () => {
  it('alone is a tap, however long it is held', () => {
    const { drag, turn, tapped } = made();
    for (let repeats = 0; repeats < 5; ++repeats) drag.hold();
    lift('L');
    expect(tapped).toHaveBeenCalledOnce();
    expect(turn).not.toHaveBeenCalled();
  });

  it('with a drag that is no number turns nothing', () => {
    const { drag, turn } = made();
    drag.hold();
    for (const far of [NaN, Infinity]) expect(drag.drag(far, 0)).toBe(true);
    expect(turn).not.toHaveBeenCalled();
  });

  it('with a drag turns the light, and is no tap', () => {
    const { drag, turn, tapped } = made();
    drag.hold();
    expect(drag.drag(0.1, 0.2)).toBe(true);
    drag.hold(); // repeated by the keyboard
    lift('l');
    expect(turn).toHaveBeenCalledExactlyOnceWith({ right: 0.1, up: 0.2 });
    expect(tapped).not.toHaveBeenCalled();
  });

  it('is not needed once it is chosen that drags turn the light', () => {
    const { drag, turn, tapped } = made();
    drag.isChosen = true;
    expect(drag.drag(0.3, 0)).toBe(true);
    lift('l');
    expect(turn).toHaveBeenCalledExactlyOnceWith({ right: 0.3, up: 0 });
    drag.isChosen = false;
    expect(drag.drag(0.3, 0)).toBe(false);
    expect(tapped).not.toHaveBeenCalled();
  });

  it('leaves drags alone when it is up, or went up elsewhere', () => {
    const { drag, turn, tapped } = made();
    expect(drag.drag(1, 1)).toBe(false);
    drag.hold();
    page.dispatchEvent(new Event('blur'));
    expect(drag.drag(1, 1)).toBe(false);
    lift('l');
    lift('x');
    expect(turn).not.toHaveBeenCalled();
    expect(tapped).not.toHaveBeenCalled();
  });
});
