// SPDX-License-Identifier: MIT
// What tools share.
import type { LengthScale } from '../../src/tools/units.js';
import type { Pointing } from '../../src/tools/pointing.js';
import type { Bench, Teller } from './bench.js';
import type { NotebookStore } from './notebook.js';
import type { ToolSettings } from './tool_settings.js';

export interface Workshop {
  readonly bench: Bench;
  readonly pointing: Pointing;
  readonly settings: ToolSettings;
  readonly notebook: NotebookStore;
  readonly story: Teller;
  /// In which lengths are told.
  readonly scale: () => LengthScale;
  /// Settings have changed.
  readonly chosen: () => void;
}
