// SPDX-License-Identifier: MIT
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Solid } from '../../page/gallery/solid.js';

const made = vi.hoisted(() => [] as { url: string; turns: unknown[]; closed: boolean; drawn: () => void }[]);

vi.mock('../../page/view/model_view.js', () => ({
  RootPicture: class {
    readonly canvas = {};
    private readonly entry;
    constructor(url: string, _shape: unknown, turn: unknown, drawn: () => void) {
      this.entry = { url, turns: [turn], closed: false, drawn };
      made.push(this.entry);
    }

    show(turn: unknown): void {
      this.entry.turns.push(turn);
    }

    close(): void {
      this.entry.closed = true;
    }
  },
}));

const SHAPE = { ends: new Float32Array(6), formBegin: 0, ball: { centre: [0, 0, 0] as const, radius: 2 }, up: 'y' as const, first: { yaw: 0, pitch: 0 }, fit: { zoom: 1, right: 0, up: 0 } };
const [FIRST, NEXT] = [{ yaw: 0, pitch: 0 }, { yaw: 1, pitch: 0 }];

function makeStage(isVisible = true): { stage: HTMLElement; classes: Set<string> } {
  const classes = new Set<string>();
  const classList = { add: (name: string) => { classes.add(name); }, remove: (name: string) => { classes.delete(name); } };
  const stage = { classList, append: () => undefined, checkVisibility: () => isVisible };
  return { stage: stage as unknown as HTMLElement, classes };
}

describe('the shaded root of a cell', () => {
  beforeEach(() => {
    made.length = 0;
    vi.useFakeTimers();
    vi.stubGlobal('window', globalThis);
  });
  afterEach(() => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });

  it('comes to what is pointed at for a while, and turns on from where the outline is', async () => {
    const { stage, classes } = makeStage();
    const solid = new Solid('a.hier', stage);
    solid.await(SHAPE, FIRST);
    solid.show(NEXT);
    expect(made).toHaveLength(0);
    await vi.advanceTimersByTimeAsync(2000);
    await vi.waitFor(() => { expect(made).toMatchObject([{ url: 'a.hier', turns: [NEXT] }]); });
    expect(classes.has('solid')).toBe(false); // nothing is drawn yet
    made[0].drawn();
    expect(classes.has('solid')).toBe(true);
    solid.end();
    expect(made[0].closed).toBe(true);
    expect(classes.has('solid')).toBe(false);
  });

  it('asks for nothing where a pointer passes by', async () => {
    const solid = new Solid('a.hier', makeStage().stage);
    solid.await(SHAPE, FIRST);
    await vi.advanceTimersByTimeAsync(300);
    solid.end();
    await vi.advanceTimersByTimeAsync(5000);
    expect(made).toHaveLength(0);
  });

  it('draws nothing in a cell that was left while its code came', async () => {
    const solid = new Solid('a.hier', makeStage(false).stage);
    solid.await(SHAPE, FIRST);
    await vi.advanceTimersByTimeAsync(2000);
    await vi.dynamicImportSettled();
    expect(made).toHaveLength(0);
    solid.end();
  });
});
