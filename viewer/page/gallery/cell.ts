// SPDX-License-Identifier: MIT
// The gallery shows an entry as a cell: an element that can be put into a list and taken out again.

export interface Cell {
  readonly root: HTMLLIElement;
  /// It has been near the window for a moment.
  load(): void;
  /// Its size is another one, or the theme.
  redraw(): void;
  /// It is gone from the listing for good.
  close(): void;
}
