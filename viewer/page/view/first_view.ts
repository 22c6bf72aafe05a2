// SPDX-License-Identifier: MIT
// How the model is seen first, as its manifest says: the page shows it so where the link says nothing else.
import type { Manifest } from '../../src/index.js';
import { poseOf } from '../../src/view/pose.js';
import { standingOf } from '../../src/view/view_look.js';
import type { View } from '../../src/view/view_table.js';
import type { Pose } from '../address.js';
import type { PageContext } from './page_context.js';

export class FirstView {
  private manifest: Manifest | null = null;

  /// `come`: there is one, which is to be shown.
  constructor(context: PageContext, come: () => void) {
    context.addEventListener('manifest', ({ manifest }) => {
      const isNew = this.manifest === null;
      this.manifest = manifest;
      if (isNew && Object.keys(manifest.view).length > 0) come();
    });
  }

  /// Empty: nothing is said, or not yet.
  get view(): View {
    return this.manifest?.view ?? {};
  }
}

/// From where a model is seen first that stands so; null: its view does not say it, or the model stands otherwise there.
export function firstPose(manifest: Manifest | null, standing: { readonly up: string; readonly stretch: number }): Pose | null {
  const view = manifest?.view ?? {};
  const { up, stretch } = standingOf(view);
  return view.camera === undefined || up !== standing.up || stretch !== standing.stretch ? null : poseOf(view.camera);
}
