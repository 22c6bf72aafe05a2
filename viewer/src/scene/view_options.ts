// SPDX-License-Identifier: MIT
// The options that a view is made with, and the events that it tells.
import type { Object3DEventMap } from 'three';
import type { Fetch } from '../hierarchy/bytes.js';
import type { RemoteFiles } from '../hierarchy/files.js';
import type { Look, Settings } from './settings.js';
import type { Standing } from './standing.js';

export interface ViewOptions {
  settings?: Partial<Settings>;
  look?: Partial<Look>;
  standing?: Partial<Standing>;
  /// Makes a worker of the module `tile_worker`; without it tiles are decoded where the view is.
  createWorker?: () => Worker;
  /// Workers that decode, at the most.
  workers?: number;
  /// Called instead of the global one.
  fetch?: Fetch;
  /// Read instead of those at the URL.
  files?: RemoteFiles;
  /// Most tiles on their way at once.
  requests?: number;
}

export interface ViewEvents extends Object3DEventMap {
  /// There is something new to draw: call `update` before the next frame.
  change: object;
  /// A file failed; the view goes on with what it has. `files`: how many are missing by now.
  problem: { message: string; files: number };
  /// All that had failed has come.
  recovered: object;
  /// The host has another build by now, and what is shown stays as it is. `reload()` begins anew; not where `isLasting`: the page holds the
  /// model itself.
  replaced: { isLasting: boolean };
}
