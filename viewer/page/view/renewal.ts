// SPDX-License-Identifier: MIT
// A model that begins anew in a view that stays: when the host has another one by now, or may be back.
import type { HierarchyView, Manifest } from '../../src/index.js';
import type { Telling } from '../problems.js';
import { words } from '../words/words.js';

const AGAIN = 20_000; // milliseconds until a host that did not answer is asked again

export interface RenewalSurroundings {
  view: HierarchyView;
  /// Of the model.
  name: string;
  failed: (message: string, telling: Telling) => () => void;
  /// The view has opened, or has not.
  opened(): void;
  refused(error: unknown): void;
  /// Opens the model in a view of its own.
  again(): void;
}

/// Whether places in the tiles of one are the same places in those of the other.
function isSamePlace(one: Manifest, other: Manifest): boolean {
  const placeOf = ({ origin, place, up, transform, units }: Manifest): string => JSON.stringify([origin, place, up, transform, units]);
  return placeOf(one) === placeOf(other);
}

export class Renewal {
  private timer = 0;
  private known: Manifest | null = null;

  constructor(private readonly around: RenewalSurroundings) {
    around.view.addEventListener('replaced', ({ isLasting }) => { this.tell(isLasting); });
  }

  /// A host that may be back is asked again.
  later(): void {
    this.timer = window.setTimeout(() => void this.reload(), AGAIN);
  }

  /// True: it is another one whose places are others. Then all begins anew, and nothing that was measured holds.
  know(manifest: Manifest): boolean {
    const isElsewhere = this.known !== null && this.known !== manifest && !isSamePlace(this.known, manifest);
    this.known = manifest;
    if (isElsewhere) queueMicrotask(() => { this.around.again(); });
    return isElsewhere;
  }

  close(): void {
    window.clearTimeout(this.timer);
  }

  private tell(isLasting: boolean): void {
    const { name, failed } = this.around;
    const { replaced, replacedMore, hostReplaced, hostReplacedMore } = words.problems;
    if (isLasting) {
      failed(hostReplaced(name), { more: hostReplacedMore, subject: 'replaced' });
      return;
    }
    const reload = (): void => {
      done();
      void this.reload();
    };
    const done = failed(replaced(name), { more: replacedMore, subject: 'replaced', retry: reload, retryText: words.parts.reload });
  }

  /// With what the host has now; the camera, the look, and what was measured stay.
  private async reload(): Promise<void> {
    this.close();
    try {
      await this.around.view.reload();
      this.around.opened();
    } catch (error) {
      this.around.refused(error);
    }
  }
}
