// `window.meshhier`: the page for scripts and tests.
import type { Stats } from '../src/scene/settings.js';
import type { Pose } from './address.js';
import type { App } from './app.js';
import type { Model } from './listing.js';
import type { HierarchyView } from '../src/index.js';

export interface Hook {
  /// Of the open model; null in the gallery and before the model's code is there.
  stats(): Stats | null;
  camera(): Pose | null;
  /// At once, without a flight.
  setCamera(pose: Pose): void;
  /// The view stands still, is drawn, and nothing is left to fetch or refine.
  settled(): boolean;
  readonly view: HierarchyView | null;
  /// Of the listing, as soon as the gallery has been shown.
  readonly models: readonly Model[];
  /// By name or path. False if the listing has no such model.
  open(name: string): boolean;
  /// Back to the gallery.
  close(): void;
}

declare global {
  interface Window {
    meshhier: Hook;
  }
}

export function installHook(app: App): void {
  window.meshhier = {
    stats: () => app.view?.stats() ?? null,
    camera: () => app.view?.pose() ?? null,
    setCamera: (pose) => { app.view?.setPose(pose); },
    settled: () => app.view?.settled() ?? false,
    get view() { return app.view?.view ?? null; },
    get models() { return app.models; },
    open: (name) => app.open(name),
    close: () => { app.close(); },
  };
}
