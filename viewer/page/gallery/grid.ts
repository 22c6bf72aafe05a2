// SPDX-License-Identifier: MIT
// Where cells of one size lie in a page: groups one below the other, each with a heading and rows of cells. All lengths are CSS pixels.

export interface Metrics {
  /// The page's.
  width: number;
  /// A cell is as wide as that or wider, unless the page is narrower.
  leastWidth: number;
  gap: number;
  /// The height of what is below a cell's square picture.
  textHeight: number;
  /// The height of a group's name, with the room around it.
  headingHeight: number;
}

export interface GroupSize {
  /// Number of items.
  count: number;
  hasHeading: boolean;
}

/// The items [first, end) of a group.
export interface CellRun {
  group: number;
  first: number;
  end: number;
}

interface GroupPlace {
  top: number;
  /// The top of the first row of cells.
  cellsTop: number;
  bottom: number;
  count: number;
}

function clamp(value: number, least: number, most: number): number {
  return Math.min(Math.max(value, least), most);
}

export class Grid {
  readonly columns: number;
  readonly cellWidth: number;
  readonly cellHeight: number;
  /// The height of all groups together.
  readonly height: number;
  private readonly bands: GroupPlace[] = [];

  constructor(extents: readonly GroupSize[], private readonly metrics: Metrics) {
    const { width, leastWidth, gap, textHeight } = metrics;
    this.columns = Math.max(Math.floor((width + gap) / (leastWidth + gap)), 1);
    this.cellWidth = Math.max((width - gap * (this.columns - 1)) / this.columns, 1);
    this.cellHeight = this.cellWidth + textHeight;
    let top = 0;
    for (const extent of extents) top = this.add(extent, top);
    this.height = Math.max(top - gap, 0);
  }

  /// Where a group begins, and how high it is.
  bandOf(group: number): { top: number; height: number } {
    const { top, bottom } = this.bands[group];
    return { top, height: bottom - top };
  }

  /// Where a cell is, within its group.
  placeOf({ group, item }: { group: number; item: number }): { left: number; top: number } {
    const { top, cellsTop } = this.bands[group];
    const { gap } = this.metrics;
    const row = Math.floor(item / this.columns);
    return {
      left: (item % this.columns) * (this.cellWidth + gap),
      top: cellsTop - top + row * (this.cellHeight + gap),
    };
  }

  /// The cells that lie between two heights, in whole rows; of each group that reaches between them a run, perhaps empty.
  runsBetween(top: number, bottom: number): CellRun[] {
    const runs: CellRun[] = [];
    for (let group = this.firstBandBelow(top); group < this.bands.length && this.bands[group].top < bottom; ++group)
      runs.push(this.runOf(group, top, bottom));
    return runs;
  }

  private add({ count, hasHeading }: GroupSize, top: number): number {
    const { gap, headingHeight } = this.metrics;
    const cellsTop = top + (hasHeading ? headingHeight : 0);
    const bottom = cellsTop + Math.ceil(count / this.columns) * (this.cellHeight + gap);
    this.bands.push({ top, cellsTop, bottom, count });
    return bottom;
  }

  /// By halving: there may be thousands of groups.
  private firstBandBelow(height: number): number {
    let [first, end] = [0, this.bands.length];
    while (first < end) {
      const middle = (first + end) >> 1;
      if (this.bands[middle].bottom > height) end = middle;
      else first = middle + 1;
    }
    return first;
  }

  private runOf(group: number, top: number, bottom: number): CellRun {
    const { cellsTop, count } = this.bands[group];
    const pitch = this.cellHeight + this.metrics.gap;
    const row = (height: number, round: (rows: number) => number): number => clamp(round((height - cellsTop) / pitch) * this.columns, 0, count);
    return { group, first: row(top, Math.floor), end: row(bottom, Math.ceil) };
  }
}
