// SPDX-License-Identifier: MIT
// A model, as large as the window, and all that can be done with it.
import type { HierarchyView, Stats } from '../../src/index.js';
import type { Pose, Spot } from '../address.js';
import { Chrome } from './chrome.js';
import { Gestures } from './gestures.js';
import { listenToKeys } from './keys.js';
import { Notices } from './notices.js';
import type { Arrival } from './page_context.js';
import { ViewParts } from './view_parts.js';
import '../style/view.css';

export { RootPicture } from './root_picture.js'; // for the gallery, which has loaded this by then

export class ModelView {
  private readonly parts: ViewParts;
  private readonly chrome: Chrome;

  /// Throws Error where there is no WebGL 2.
  constructor(private readonly arrival: Arrival) {
    const parts = new ViewParts(arrival);
    this.parts = parts;
    const { context, camera, light } = parts;
    new Notices(context, parts.frames);
    this.chrome = new Chrome(parts);
    const { surface, view: { plugins } } = context;
    new Gestures(surface, camera.navigation, (right, up) => plugins.tapped(right, up), (right, up) => light.drag(right, up));
    listenToKeys(parts, this.chrome);
    parts.follow(arrival.spot);
    context.addEventListener('rested', () => { arrival.entry.write(parts.spot()); });
  }

  /// Once it is on the page.
  start(): void {
    const { parts: { choices, context, renewal, frames }, arrival: { page, spot } } = this;
    choices.show();
    if (page.preferences.panel) this.chrome.panel.open();
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

  pose(): Pose {
    return this.parts.camera.pose();
  }

  /// Null: all of the model.
  setPose(pose: Pose | null): void {
    this.parts.camera.setPose(pose);
  }

  /// As a link says.
  setSpot(spot: Spot): void {
    this.setPose(spot.pose);
    this.parts.follow(spot);
  }

  stats(): Stats {
    return this.view.stats();
  }

  settled(): boolean {
    return this.parts.frames.isSettled;
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
