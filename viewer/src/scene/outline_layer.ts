// SPDX-License-Identifier: MIT
// The outline of a view: fetched when it is first to be seen.
import type { Outline } from '../hierarchy/outline.js';
import { HierarchyProblem } from '../hierarchy/problem.js';
import type { FileHost } from './opening.js';
import { OutlineObject } from './outline_object.js';
import type { ViewContext } from './view_context.js';

export class OutlineLayer {
  private object: OutlineObject | null = null;
  private isWanted = false;
  private loading: object | null = null; // the newest attempt; what will not pass is not tried again

  constructor(
    private readonly context: ViewContext,
    private readonly host: FileHost,
  ) {}

  /// `place`: what the tiles' positions are relative to.
  show(isWanted: boolean, fetch: () => Promise<Outline>, place: readonly [number, number, number]): void {
    this.isWanted = isWanted;
    if (this.object !== null) this.object.visible = isWanted;
    else if (isWanted && this.loading === null) void this.load(fetch, place);
  }

  /// Forgets the outline, as before it was asked for.
  clear(): void {
    this.object?.dispose();
    this.object = this.loading = null;
  }

  private async load(fetch: () => Promise<Outline>, place: readonly [number, number, number]): Promise<void> {
    const attempt = {};
    this.loading = attempt;
    try {
      const outline = await fetch();
      if (this.loading !== attempt) return;
      this.object = new OutlineObject(outline, place);
      this.object.visible = this.isWanted;
      this.context.tiles.add(this.object);
      this.host.recover('outline');
      this.context.changed();
    } catch (problem) {
      if (this.loading !== attempt) return;
      if (problem instanceof HierarchyProblem && problem.mayPass) this.loading = null; // asked for again when it is switched on again
      this.host.tell('outline', problem);
    }
  }
}
