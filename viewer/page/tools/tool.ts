// SPDX-License-Identifier: MIT
// A tool of the bar.
import type { Mark } from '../../src/plugins/overlay.js';

export interface Tool {
  /// Its card holds this. Parts of the class `tool-extra` are not in the strip that the card is on phones.
  readonly root: HTMLElement;
  /// A place of the picture, from -1 to 1 to the right and up.
  choose?(right: number, up: number): void;
  /// False: it is none of the tool's keys.
  key?(key: string): boolean;
  /// One step back. False: there is none.
  undo?(): boolean;
  marks?(): readonly Mark[];
  /// Called after each frame.
  drawn?(): void;
  /// Says what goes on when its card is closed, in a few words; null: nothing does.
  lasting?(): string | null;
  /// Ends what goes on.
  end?(): void;
  /// It is put away.
  close?(): void;
}
