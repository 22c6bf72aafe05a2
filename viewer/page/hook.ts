// SPDX-License-Identifier: MIT
// `window.meshhier`: the page for scripts and tests.
import type { Stats } from '../src/scene/settings.js';
import { problemOfPose, type Pose } from './address.js';
import type { App } from './app.js';
import type { Model } from './listing.js';
import type { HierarchyView } from '../src/index.js';
import type { PairStats } from '../src/pair/index.js';

export interface Hook {
  /// Figures of the open model; null in the gallery and before the model's code is there.
  stats(): Stats | null;
  camera(): Pose | null;
  /// At once, without a flight. Throws RangeError if no camera can stand so.
  setCamera(pose: Pose): void;
  /// The view stands still, is drawn, and nothing is left to fetch or refine.
  settled(): boolean;
  /// Figures of both models of a comparison, and the second one; null: there is none, or its code is not there.
  pair(): PairStats | null;
  readonly other: HierarchyView | null;
  readonly view: HierarchyView | null;
  /// Models of the listing, as soon as the gallery has been shown.
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

function isList(value: unknown): value is readonly unknown[] {
  return Array.isArray(value);
}

/// Scripts may give anything.
export function checkedPose(given: unknown): Pose {
  const { position, target } = (given ?? {}) as Partial<Record<keyof Pose, unknown>>;
  const problem = problemOfPose(isList(position) ? position : [], isList(target) ? target : []);
  if (problem !== null) throw new RangeError(`setCamera: ${problem}`);
  return given as Pose;
}

export function installHook(app: App): void {
  window.meshhier = {
    stats: () => app.view?.stats() ?? null,
    camera: () => app.view?.pose() ?? null,
    setCamera: (pose) => {
      const checked = checkedPose(pose);
      app.view?.setPose(checked);
    },
    settled: () => app.view?.settled() ?? false,
    pair: () => app.view?.pair?.stats() ?? null,
    get other() { return app.view?.pair?.view ?? null; },
    get view() { return app.view?.view ?? null; },
    get models() { return app.models; },
    open: (name) => app.open(name),
    close: () => { app.close(); },
  };
}
