// SPDX-License-Identifier: MIT
import { Scene, Vector3, type WebGLRenderer } from 'three';
import { afterAll, afterEach, beforeAll, beforeEach, describe, expect, it, vi } from 'vitest';
import { CameraPose, type Stage } from '../src/index.js';
import { Clipping } from '../src/plugins/clipping.js';
import { Immersion } from '../src/plugins/immersion.js';
import { ImmersionSession } from '../src/plugins/immersion_session.js';
import { Measuring } from '../src/plugins/measuring.js';
import { Stories } from '../src/plugins/stories.js';
import type { Notebook } from '../src/tools/note.js';
import { fetchFrom, hasProgram, Workshop } from './support/meshhier.js';
import { Session } from './support/session.js';

const STORY: Notebook = {
  notes: [
    { at: [0, 0, 1], text: 'one', view: { position: [0, 0, 3], target: [0, 0, 1], choices: 'wires=on' } },
    { at: [1, 0, 0], text: 'two' },
  ],
  bookmarks: [],
};

describe.skipIf(!hasProgram)('a plug-in of the library', () => {
  const workshop = new Workshop();
  const render = vi.fn();
  const renderer = { render, clippingPlanes: [], clearStencil: vi.fn() } as unknown as WebGLRenderer;
  const [travel, present, redraw] = [vi.fn(() => 500), vi.fn(), vi.fn()];
  let directory: string;
  let session: Session;
  let stage: Stage;

  beforeAll(() => { directory = workshop.build('ball', ['surface', '--triangles', '2000', '--shape', 'torus'], { partition: { vertices: 500 } }); });
  beforeEach(async () => {
    vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout', 'performance'] });
    for (const mock of [render, travel, present, redraw]) mock.mockClear();
    session = new Session(fetchFrom(directory));
    await session.view.opened;
    session.look([0, 0, 4], [0, 0, 0]);
    const surface = new EventTarget() as HTMLElement;
    const pose = (): CameraPose => new CameraPose(new Vector3(0, 0, 4), new Vector3());
    const { view, camera } = session;
    stage = { view, renderer, scene: new Scene(), camera, root: {} as ParentNode, surface, signal: new AbortController().signal, pose, jump: vi.fn(), fly: vi.fn(), travel, redraw, suspend: vi.fn(), present };
    view.plugins.enter(stage);
  });
  afterEach(() => {
    session.view.dispose();
    vi.useRealTimers();
  });
  afterAll(() => { workshop.remove(); });

  it('tells a story, note by note, as each wants to be seen', async () => {
    const stories = new Stories(STORY);
    const told = vi.fn();
    stories.addEventListener('told', told);
    session.view.registerPlugin(stories);
    stories.go(0);
    expect(travel).not.toHaveBeenCalled(); // nothing is known of the model
    await session.settle();
    stories.go(0);
    expect(present).toHaveBeenLastCalledWith('wires=on');
    stories.go(1);
    stories.go(2);
    stories.go(-1);
    expect([stories.step, travel.mock.calls.length, told.mock.calls.length, stories.marks().length]).toEqual([1, 2, 2, 2]);
  });

  it('tells it by itself, until the model is touched', async () => {
    await session.settle();
    const stories = new Stories(STORY);
    session.view.registerPlugin(stories);
    stories.togglePlaying();
    expect([stories.step, stories.isPlaying]).toEqual([0, true]);
    vi.advanceTimersByTime(5000);
    expect(stories.step).toBe(1);
    stage.surface.dispatchEvent(new Event('pointerdown'));
    expect(stories.isPlaying).toBe(false);
    stories.togglePlaying();
    session.view.unregisterPlugin(stories);
    vi.advanceTimersByTime(60_000);
    expect([stories.step, stories.isPlaying]).toEqual([0, false]);
  });

  it('cuts the model open, and leaves it whole', async () => {
    await session.settle();
    const clipping = new Clipping();
    const view = session.view.registerPlugin(clipping);
    expect(clipping.paint(stage)).toBe(false);
    clipping.cut([{ normal: [1, 0, 0], constant: 0 }]);
    expect([view.showsInside, clipping.paint(stage), render.mock.calls.length]).toEqual([true, true, 1]);
    expect([view.plugins.keeps(new Vector3(1, 0, 0)), view.plugins.keeps(new Vector3(-1, 0, 0))]).toEqual([true, false]);
    view.unregisterPlugin(clipping);
    expect([view.showsInside, view.plugins.keeps(new Vector3(-1, 0, 0)), clipping.paint(stage)]).toEqual([false, true, false]);
  });

  it('cuts as it was told before it came, and draws each other cut', async () => {
    await session.settle();
    const clipping = new Clipping('mine');
    clipping.cut([{ normal: [1, 0, 0], constant: 0 }]);
    const view = session.view.registerPlugin(clipping);
    expect([view.plugins.named('mine'), view.showsInside, clipping.paint(stage)]).toEqual([clipping, true, true]);
    await session.settle();
    const changed = vi.fn();
    view.addEventListener('change', changed);
    clipping.cut([{ normal: [1, 0, 0], constant: 0.5 }]);
    expect(changed).toHaveBeenCalled();
    expect(await session.frame()).toBe(true);
  });

  it('forgets places when the model lies elsewhere', async () => {
    session.camera.updateProjectionMatrix();
    await session.settle();
    const { view } = session;
    const [clipping, measuring, stories] = [new Clipping(), new Measuring({ isAlone: false }), new Stories(STORY)];
    for (const each of [clipping, measuring, stories]) view.registerPlugin(each);
    const middles = [-0.6, -0.4, -0.2, 0, 0.2, 0.4, 0.6];
    expect(middles.some((right) => measuring.choose(right, 0))).toBe(true);
    clipping.cut([{ normal: [1, 0, 0], constant: 0 }]);
    const draw = (): void => { view.draw(renderer, stage.scene, session.camera); };
    draw();
    const [first, place] = [view.manifest!, stories.marks()[0]];
    const manifest = vi.spyOn(view, 'manifest', 'get');
    manifest.mockReturnValue({ ...first });
    draw();
    expect([measuring.points.length, view.showsInside]).toEqual([1, true]); // another build of the same places
    manifest.mockReturnValue({ ...first, origin: [first.origin[0] + 1, first.origin[1], first.origin[2]] });
    draw();
    expect([measuring.points.length, view.showsInside]).toEqual([0, false]);
    expect(stories.marks()[0].distanceTo(place)).toBeCloseTo(1);
    clipping.cut([{ normal: [1, 0, 0], constant: 0 }]);
    draw();
    expect(view.showsInside).toBe(true);
    manifest.mockRestore();
  });

  it('does not play before something is known of the model', () => {
    const stories = new Stories(STORY);
    session.view.registerPlugin(stories);
    stories.togglePlaying();
    expect([stories.isPlaying, session.view.manifest]).toEqual([false, null]);
  });

  it('measures between points of the surface', async () => {
    session.camera.updateProjectionMatrix();
    await session.settle();
    const measuring = new Measuring({ isAlone: false, tell: (length) => `${length > 0}` });
    const changed = vi.fn();
    measuring.addEventListener('change', changed);
    session.view.registerPlugin(measuring);
    const places = [-0.6, -0.4, -0.2, 0, 0.2, 0.4, 0.6].flatMap((right) => [-0.4, 0, 0.4].map((up) => [right, up] as const));
    const hit = places.filter(([right, up]) => measuring.choose(right, up));
    expect(hit.length).toBeGreaterThan(1);
    expect([measuring.points.length, measuring.marks().length, changed.mock.calls.length >= hit.length]).toEqual([hit.length, 2 * hit.length - 1, true]);
    expect(measuring.measures().length).toBeGreaterThan(0);
    expect(measuring.marks()[0].text).toBe('true');
    expect(measuring.tapped(...hit[0])).toBe(false); // taps are its owner's
    expect(measuring.choose(0.99, 0.99)).toBe(false);
    measuring.keep(1);
    expect(measuring.points.length).toBe(1);
  });

  it('goes to no room before something is known of the model', async () => {
    const immersion = new Immersion();
    session.view.registerPlugin(immersion);
    await expect(immersion.start('immersive-vr')).resolves.toBeUndefined(); // nobody is asked
  });

  it('leaves the room that it has not reached when it is taken away', async () => {
    await session.settle();
    const room = { stop: vi.fn() };
    let enterRoom!: (session: ImmersionSession) => void;
    const start = vi.spyOn(ImmersionSession, 'start').mockReturnValue(new Promise((resolve) => { enterRoom = resolve; }));
    const immersion = new Immersion();
    session.view.registerPlugin(immersion);
    const suspend = vi.spyOn(stage, 'suspend');
    const started = immersion.start('immersive-vr');
    session.view.unregisterPlugin(immersion);
    enterRoom(room as unknown as ImmersionSession);
    await started;
    expect([room.stop.mock.calls.length, suspend.mock.calls.length]).toEqual([1, 0]);
    start.mockRestore();
  });
});
