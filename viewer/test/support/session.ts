// SPDX-License-Identifier: MIT
// A view without a GPU, whose frames come when a test says. Needs fake timers.
import { PerspectiveCamera, Vector3, type Mesh } from 'three';
import { vi } from 'vitest';
import type { Fetch } from '../../src/hierarchy/bytes.js';
import { HierarchyView, type ViewOptions } from '../../src/index.js';

const VIEWPORT = { width: 800, height: 600 };
const FRAME = 50;
const SOON = 100; // frames that need no waiting

/// The real clock's, as long as no test has put another in its place.
const realTimeout = globalThis.setTimeout;

export type Place = readonly [number, number, number];

/// A view with a clock of its own.
export class Session {
  readonly camera = new PerspectiveCamera(45, VIEWPORT.width / VIEWPORT.height, 1e-3, 100);
  readonly problems: string[] = [];
  missing = 0; // files
  readonly view: HierarchyView;
  private now = 0;

  constructor(fetch: Fetch, options: ViewOptions = {}, url = '') {
    this.view = new HierarchyView(url, { fetch, ...options });
    this.view.addEventListener('problem', ({ message, files }) => {
      this.problems.push(message);
      this.missing = files;
    });
    this.view.addEventListener('recovered', () => { this.missing = 0; });
  }

  look(from: Place, at: Place): void {
    this.camera.position.set(...from);
    this.camera.lookAt(new Vector3(...at));
  }

  async frame(): Promise<boolean> {
    this.now += FRAME;
    vi.advanceTimersByTime(FRAME);
    const news = this.view.update(this.camera, VIEWPORT, this.now);
    await new Promise((resolve) => setImmediate(resolve));
    return news;
  }

  /// Frames until all is there, or so many seconds are over. What is unpacked takes real time: frames wait for it, so that a busy
  /// machine decides nothing.
  async settle(seconds = 30): Promise<boolean> {
    for (const begin = this.now; this.now < begin + 1000 * seconds; ) {
      await this.frame();
      if (this.view.stats().settled) return true;
      if (this.now > begin + SOON * FRAME) await new Promise((resolve) => realTimeout(resolve, 2));
    }
    return false;
  }

  /// Those that would be drawn.
  meshes(): Mesh[] {
    const found: Mesh[] = [];
    this.view.traverseVisible((object) => {
      if ('isMesh' in object) found.push(object as Mesh);
    });
    return found;
  }

  /// The tiles that would be drawn, in view or not, in order, and what of each.
  cut(): string[] {
    const meshes = this.meshes().sort((a, b) => a.renderOrder - b.renderOrder);
    return meshes.map(({ geometry: { attributes: { position }, drawRange } }) =>
      [drawRange.count, position.count, ...position.array.slice(0, 3)].join());
  }
}
