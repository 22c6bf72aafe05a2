// SPDX-License-Identifier: MIT
// A model, as large as the window, and all that can be done with it.
import type { HierarchyView, Stats } from '../../src/index.js';
import type { Pose, Spot } from '../address.js';
import { FirstParts } from './first_parts.js';
import type { Furniture } from './furniture.js';
import type { PagePair } from '../pair/page_pair.js';
import { Gestures } from './gestures.js';
import { Notices } from './notices.js';
import type { Arrival } from './page_context.js';
import '../style/view.css';

export { RootPicture } from './root_picture.js'; // for the gallery, which has loaded this by then

/// So long the rest of the view waits for the first picture.
const PATIENCE = 3000; // milliseconds

export class ModelView {
  private readonly parts: FirstParts;
  /// Null: the first picture comes first.
  private furniture: Furniture | null = null;
  private isFurnishing = false;
  private spot: Spot;

  /// Throws Error where there is no WebGL 2.
  constructor(private readonly arrival: Arrival) {
    const parts = new FirstParts(arrival, () => { this.follow(); });
    [this.parts, this.spot] = [parts, arrival.spot];
    const { context, frames } = parts;
    new Notices(context, frames);
    const { root, surface, view: { plugins } } = context;
    new Gestures(surface, this.hands(), (right, up) => plugins.tapped(right, up), (right, up) => this.furniture?.parts.light.drag(right, up) ?? false);
    root.append(surface);
    context.addEventListener('shown', () => { arrival.poster?.fade(); });
    context.addEventListener('refused', () => { arrival.poster?.end(); });
    for (const type of ['shown', 'refused'] as const) context.addEventListener(type, () => void this.furnish());
    const timer = window.setTimeout(() => void this.furnish(), PATIENCE);
    context.signal.addEventListener('abort', () => { window.clearTimeout(timer); });
  }

  /// The camera for hands, which take places of the whole picture.
  private hands(): ConstructorParameters<typeof Gestures>[1] {
    const { context: { canvas }, camera: { navigation } } = this.parts;
    return {
      grab: (right, up) => { navigation.grab(...canvas.inColumn(right, up)); },
      approach: (right, up) => { navigation.approach(...canvas.inColumn(right, up)); },
      grabMiddle: () => { navigation.grabMiddle(); },
      move: (moves) => { navigation.move(moves); },
    };
  }

  /// Once it is on the page.
  start(): void {
    const { parts: { choices, context, renewal, frames }, arrival: { spot } } = this;
    choices.show();
    this.follow();
    if (spot.pose !== null) this.setPose(spot.pose);
    context.surface.focus({ preventScroll: true });
    void renewal.open();
    frames.start();
  }

  get root(): HTMLElement {
    return this.parts.context.root;
  }

  get view(): HierarchyView {
    return this.parts.context.view;
  }

  /// Two models are compared; null: they are not.
  get pair(): PagePair | null {
    return this.furniture?.parts.pair.shown ?? null;
  }

  pose(): Pose {
    return this.parts.camera.pose();
  }

  /// Null: as the model is seen first.
  setPose(pose: Pose | null): void {
    this.parts.camera.setPose(pose);
  }

  /// As a link says.
  setSpot(spot: Spot): void {
    this.spot = spot;
    this.setPose(spot.pose);
    this.follow();
  }

  /// What the link says, as far as there is somebody to hear it.
  private follow(): void {
    (this.furniture?.parts ?? this.parts).follow(this.spot);
  }

  stats(): Stats {
    return this.view.stats();
  }

  settled(): boolean {
    return this.furniture?.parts.pair.isThere === true && this.parts.frames.isSettled;
  }

  /// Once; again if the code did not come.
  private async furnish(): Promise<void> {
    const { parts, parts: { context } } = this;
    if (this.isFurnishing) return;
    this.isFurnishing = true;
    try {
      const { Furniture } = await import('./furniture.js');
      if (!context.signal.aborted) this.furniture = new Furniture(parts, this.spot);
    } catch {
      this.isFurnishing = false;
      if (!context.signal.aborted) context.missCode(() => void this.furnish());
    }
  }

  close(): void {
    const { context, frames, renewal } = this.parts;
    context.close();
    frames.stop();
    renewal.close();
    context.view.dispose();
    context.canvas.dispose();
    context.root.remove();
  }
}
