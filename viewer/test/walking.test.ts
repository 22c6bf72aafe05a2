// SPDX-License-Identifier: MIT
// Somebody walks in a house, on a stage without a picture.
import { writeFileSync } from 'node:fs';
import path from 'node:path';
import { Scene, type WebGLRenderer } from 'three';
import { afterAll, afterEach, beforeAll, beforeEach, describe, expect, it, vi } from 'vitest';
import { CameraPose, type Stage } from '../src/index.js';
import { Dollhouse } from '../src/plugins/dollhouse.js';
import { Storeys } from '../src/plugins/storeys.js';
import { Walking } from '../src/plugins/walking.js';
import { house, HOUSE, plyOf } from './support/house.js';
import { fetchFrom, hasProgram, Workshop } from './support/meshhier.js';
import { Session } from './support/session.js';

const EYES = 1.6;
const FRAME = 50; // milliseconds

class Surface extends EventTarget {
  readonly clientHeight = 600;
  focus(): void { /* nothing is typed */ }
  setPointerCapture(): void { /* nor dragged */ }
  getBoundingClientRect(): object {
    return { left: 0, top: 0, width: 800, height: 600 };
  }
}

function pressed(type: 'keydown' | 'keyup', code: string, key = code): Event {
  return Object.assign(new Event(type, { cancelable: true }), { code, key, shiftKey: false, ctrlKey: false, altKey: false, metaKey: false, isComposing: false });
}

describe.skipIf(!hasProgram)('walking', () => {
  const workshop = new Workshop();
  let directory: string;
  let session: Session;
  let stage: Stage;
  let pose: CameraPose;
  let now: number;

  beforeAll(() => {
    writeFileSync(path.join(workshop.directory, 'house.ply'), plyOf(house()));
    directory = workshop.buildMesh('house', path.join(workshop.directory, 'house.ply'), { up: 'y', partition: { vertices: 400 } });
  });
  beforeEach(async () => {
    vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout', 'performance'] });
    vi.stubGlobal('window', new EventTarget());
    vi.stubGlobal('requestAnimationFrame', () => 1);
    vi.stubGlobal('cancelAnimationFrame', () => undefined);
    session = new Session(fetchFrom(directory));
    await session.view.opened;
    session.camera.updateProjectionMatrix();
    session.look([3, EYES, 6], [8, EYES, 6]);
    await session.settle();
    pose = CameraPose.from({ position: [3, EYES, 6], target: [8, EYES, 6] });
    const jump = (to: CameraPose): void => {
      pose = to;
      session.look(to.position.toArray(), to.target.toArray());
      session.camera.updateMatrixWorld();
    };
    const surface = new Surface() as unknown as HTMLElement;
    const { view, camera } = session;
    stage = { view, renderer: { render: vi.fn() } as unknown as WebGLRenderer, scene: new Scene(), camera, root: surface, surface, signal: new AbortController().signal, pose: () => pose, jump, fly: jump, travel: () => 0, redraw: vi.fn(), suspend: vi.fn() };
    view.plugins.enter(stage);
    now = performance.now();
  });
  afterEach(() => {
    session.view.dispose();
    vi.unstubAllGlobals();
    vi.useRealTimers();
  });
  afterAll(() => { workshop.remove(); });

  function begun(): Walking {
    const walking = new Walking({ isAlone: false });
    session.view.registerPlugin(walking);
    expect(walking.start()).toBe(true);
    return walking;
  }

  function steps(walking: Walking, seconds: number): void {
    for (const end = now + 1000 * seconds; now < end; ) {
      now += FRAME;
      vi.advanceTimersByTime(FRAME);
      walking.step(now);
    }
  }

  it('begins where the camera is, without a jump, and leaves it where it is', () => {
    const walking = begun();
    expect(walking.eyeHeight).toBeCloseTo(EYES, 3);
    steps(walking, 1);
    expect(pose.position.toArray()).toEqual([3, expect.closeTo(EYES, 3), 6]);
    expect(pose.forward.x).toBeCloseTo(1, 6);
    const before = pose;
    window.dispatchEvent(pressed('keydown', 'Escape'));
    expect([walking.isWalking, pose]).toEqual([false, before]);
  });

  it('goes ahead while a key is held, to the wall', () => {
    const walking = begun();
    const key = pressed('keydown', 'KeyW', 'w');
    window.dispatchEvent(key);
    steps(walking, 3);
    expect(key.defaultPrevented).toBe(true);
    expect(pose.position.x).toBeGreaterThan(5.5);
    expect(pose.position.x).toBeLessThan(HOUSE.wall.ground[0] - 0.1);
    window.dispatchEvent(pressed('keyup', 'KeyW', 'w'));
    const { x } = pose.position;
    steps(walking, 1);
    expect(pose.position.x).toBe(x);
  });

  it('goes to the floor that is tapped, and marks it under the mouse', () => {
    const walking = begun();
    window.dispatchEvent(pressed('keydown', 'PageDown'));
    steps(walking, 0.4);
    window.dispatchEvent(pressed('keyup', 'PageDown'));
    stage.surface.dispatchEvent(Object.assign(new Event('pointermove'), { pointerId: 1, clientX: 400, clientY: 300, pointerType: 'mouse' }));
    expect(walking.marks().length).toBe(24);
    expect(walking.goTo(0, 0)).toBe(true);
    steps(walking, 3);
    expect(pose.position.x).toBeGreaterThan(3.5);
    expect(pose.position.y).toBeCloseTo(EYES, 3);
  });

  it('ends where somebody else moves the camera', () => {
    const walking = begun();
    steps(walking, 0.2);
    stage.jump(CameraPose.from({ position: [0, 30, 0], target: [5, 0, 4] }));
    const ended = vi.fn();
    walking.addEventListener('change', ended);
    steps(walking, 0.2);
    expect([walking.isWalking, ended.mock.calls.length, pose.position.y]).toEqual([false, 1, 30]);
  });

  it('refuses eyes that are no height, and takes others', () => {
    const walking = begun();
    expect(() => { walking.eyeHeight = 0; }).toThrow(RangeError);
    walking.eyeHeight = 1;
    steps(walking, 1);
    expect(pose.position.y).toBeCloseTo(1, 3);
  });

  it('is begun from above at a place of the picture that is a floor', () => {
    stage.jump(CameraPose.from({ position: [5, 25, 4.01], target: [5, 0, 4] }));
    session.view.hidesBacks = true;
    const walking = begun();
    expect(pose.position.y).toBeCloseTo(HOUSE.floors[1] + EYES, 2);
    walking.stop();
  });

  it('looks in from outside by itself, until somebody chooses', () => {
    const dollhouse = new Dollhouse();
    session.view.registerPlugin(dollhouse);
    expect([dollhouse.isOn, session.view.hidesBacks]).toEqual([true, true]);
    dollhouse.mode = 'off';
    expect(session.view.hidesBacks).toBe(false);
    session.view.unregisterPlugin(dollhouse);
    expect(session.view.hidesBacks).toBe(false);
  });

  it('shows one storey, alone or with what is below', () => {
    const storeys = new Storeys();
    const { view } = session.view.registerPlugin(storeys) && session;
    expect(storeys.storeys.map(({ floor }) => Number(floor.toFixed(3)))).toEqual(HOUSE.floors);
    const drawn = (): boolean[] => [0, 2.4, 2.9, 5.2].map((y) => view.plugins.cuts.every(({ normal, constant }) => normal.y * y + constant >= 0));
    storeys.choose(0);
    expect([drawn(), storeys.shown]).toEqual([[true, false, false, false], { number: 0, isAlone: false }]);
    storeys.choose(1, true);
    expect([drawn(), storeys.shown]).toEqual([[false, false, true, false], { number: 1, isAlone: true }]);
    storeys.choose(1);
    expect([drawn(), storeys.shown]).toEqual([[true, true, true, false], { number: 1, isAlone: false }]);
    storeys.choose(null);
    expect([view.plugins.cuts, view.showsInside, storeys.shown]).toEqual([[], false, null]);
    session.view.unregisterPlugin(storeys);
    expect(view.plugins.named('storeys cut')).toBeUndefined();
  });
});
