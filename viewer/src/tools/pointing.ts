// SPDX-License-Identifier: MIT
// From a place of the picture to a point of the model: at once as it is shown, then as it is in the original.
import { Vector3 } from 'three';
import type { Stage } from '../scene/hierarchy_view.js';
import { pickOriginal } from './original.js';
import { Picker, rayThrough, type Hit, type Keeps } from './pick.js';
import { pickedPoint, type PickedPoint } from './picked_point.js';
import type { Pointed, PointFinder } from './point_finder.js';
import { recordedBound, shownBound } from './shown_bound.js';

export class Pointing implements PointFinder {
  private readonly picker = new Picker();

  constructor(private readonly stage: Pick<Stage, 'view' | 'camera'>) {}

  /// Null: nothing of the model is there. `signal`: ends the way to the original.
  at(right: number, up: number, snaps: boolean, signal: AbortSignal): Pointed | null {
    const { view, camera } = this.stage;
    const { manifest, source } = view;
    const keeps: Keeps = (point, values) => view.plugins.keeps(new Vector3(...point).applyMatrix4(view.surfaceMatrix), values);
    const ray = { ...rayThrough(camera, right, up, view.surfaceMatrix), meetsFronts: view.hidesBacks };
    const hit = this.picker.pick(view.surface, ray, keeps);
    if (hit === null || manifest === null || source === null) return null;
    const tell = (found: Hit): PickedPoint => pickedPoint(found, manifest, snaps, shownBound(found.node, view.surface, (node) => recordedBound(source, node)));
    const original = pickOriginal(source, ray, { signal, keeps }).then((found) => found && tell(found), (problem: unknown) => {
      signal.throwIfAborted();
      console.debug(problem); // the view goes on with what is shown
      return null;
    });
    original.catch(() => undefined); // whoever waits is told; nobody must
    return { shown: tell(hit), original };
  }
}
