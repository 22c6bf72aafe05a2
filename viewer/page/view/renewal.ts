// SPDX-License-Identifier: MIT
// Opens a model, and begins anew in a view that stays: when the host has another one by now, or may be back.
import { HierarchyProblem, type Manifest } from '../../src/index.js';
import { AGAIN } from '../../src/hierarchy/problem.js';
import { Whereabouts } from '../../src/plugins/whereabouts.js';
import { words } from '../words/words.js';
import type { PageContext } from './page_context.js';

export class Renewal {
  private timer = 0;
  private readonly places = new Whereabouts();

  constructor(private readonly context: PageContext) {
    context.view.addEventListener('replaced', ({ isLasting }) => { this.tell(isLasting); });
  }

  async open(): Promise<void> {
    return this.await(this.context.view.opened);
  }

  /// True: it is another one whose places are others. Then all begins anew, and nothing that was measured holds.
  know(manifest: Manifest): boolean {
    const isElsewhere = this.places.haveChanged(manifest);
    if (isElsewhere) queueMicrotask(() => { this.context.page.dispatchEvent(new Event('again')); });
    return isElsewhere;
  }

  close(): void {
    window.clearTimeout(this.timer);
  }

  private tell(isLasting: boolean): void {
    const { model: { name }, page: { problems } } = this.context;
    const { replaced, replacedMore, hostReplaced, hostReplacedMore } = words.problems;
    if (isLasting) {
      problems.tell(hostReplaced(name), { more: hostReplacedMore, subject: 'replaced' });
      return;
    }
    const reload = (): void => {
      done();
      void this.reload();
    };
    const done = problems.tell(replaced(name), { more: replacedMore, subject: 'replaced', retry: reload, retryText: words.parts.reload });
  }

  /// With what the host has now; the camera, the look, and what was measured stay.
  private async reload(): Promise<void> {
    this.close();
    return this.await(this.context.view.reload());
  }

  private async await(opened: Promise<void>): Promise<void> {
    const { context } = this;
    try {
      await opened;
      if (context.signal.aborted) return;
      context.isOpened = true;
      context.dispatchEvent({ type: 'opened' });
    } catch (error) {
      if (context.signal.aborted) return;
      context.dispatchEvent({ type: 'refused', error });
      if (error instanceof HierarchyProblem && error.mayPass) this.timer = window.setTimeout(() => void this.reload(), AGAIN); // it may be back
    }
  }
}
