// SPDX-License-Identifier: MIT
// The frames of a model's view: what is drawn, how sharp, and when the next one is due.
import type { Manifest } from '../../src/index.js';
import { FrameLoop, type Pace } from './frame_loop.js';
import type { Renewal } from './renewal.js';
import { Sharpness } from './sharpness.js';
import type { ViewCamera } from './view_camera.js';
import type { PageContext } from './page_context.js';

/// In the browser's own account of the page's times.
const FIRST_PICTURE = 'meshhier: first picture';
const REPORT = 250; // milliseconds between two reports

export class PageFrames {
  private readonly loop = new FrameLoop((now) => this.frame(now));
  private readonly sharpness = new Sharpness();
  private readonly sizes = new ResizeObserver(() => { this.loop.wake(); });
  /// The device is lost, or somebody else draws.
  private readonly pauses = new Set<object>();
  private isRefused = false;
  private reportedAt = -Infinity;
  private manifest: Manifest | null = null;

  constructor(private readonly context: PageContext, private readonly camera: ViewCamera, private readonly renewal: Renewal) {
    context.addEventListener('wake', this.loop.wake);
    context.addEventListener('opened', () => { this.isRefused = false; });
    context.addEventListener('refused', () => {
      this.isRefused = true;
      context.redraw();
    });
    document.addEventListener('visibilitychange', () => { context.redraw(); }, { signal: context.signal });
  }

  start(): void {
    this.sizes.observe(this.context.canvas.element);
    this.loop.wake();
  }

  stop(): void {
    this.loop.stop();
    this.sizes.disconnect();
  }

  /// No frame is drawn until what it returns is called.
  pause(): () => void {
    const pause = {};
    this.pauses.add(pause);
    return () => {
      this.pauses.delete(pause);
      this.context.redraw();
    };
  }

  /// A report is due, whenever the last one was.
  reportSoon(): void {
    this.reportedAt = -Infinity;
    this.loop.wake();
  }

  /// The picture is complete, and stays as it is; while one is taken it is that one.
  get isSettled(): boolean {
    const { context: { isOpened, isDirty, view, canvas }, camera } = this;
    const isBusy = camera.busy && !camera.isFrozen;
    return isOpened && !isDirty && this.pauses.size === 0 && !isBusy && !this.sharpness.blurred && (canvas.partner?.isSettled ?? view.stats().settled);
  }

  private frame(now: number): Pace {
    if (this.pauses.size > 0) return 'rest';
    const { context, camera } = this;
    const { view, canvas } = context;
    this.greet(view.manifest);
    const moved = camera.step(now);
    const resized = canvas.fit(this.sharpness.at(now, moved, view.settings.framesPerSecond));
    camera.aim(resized);
    const news = canvas.update(now);
    if (moved || news || resized || context.isDirty) this.draw();
    context.isDirty = false;
    return this.pace(now, moved || news || camera.busy || this.sharpness.blurred);
  }

  /// Before anything is drawn that it tells of.
  private greet(manifest: Manifest | null): void {
    if (manifest === null || manifest === this.manifest) return;
    this.manifest = manifest;
    this.context.dispatchEvent({ type: 'manifest', manifest });
  }

  private draw(): void {
    const { context } = this;
    if (this.camera.isFrozen) return;
    context.canvas.draw();
    if (context.isShown || !context.isOpened) return;
    context.isShown = true;
    performance.mark(FIRST_PICTURE);
    context.dispatchEvent({ type: 'shown' });
  }

  private pace(now: number, busy: boolean): Pace {
    const { context: { view, canvas, isOpened }, isRefused } = this;
    const due = now - this.reportedAt >= REPORT;
    if (busy && !due) return 'busy';
    const stats = view.stats();
    const working = !isRefused && !((canvas.partner?.isSettled ?? stats.settled) && isOpened);
    if (view.manifest !== null) {
      if (this.renewal.know(view.manifest)) return 'rest';
      this.context.dispatchEvent({ type: 'known', manifest: view.manifest });
    }
    this.reportedAt = now;
    this.context.dispatchEvent({ type: 'report', stats, working });
    if (busy) return 'busy';
    return working ? 'waiting' : 'rest';
  }
}
