// SPDX-License-Identifier: MIT
// Takes a view into the visitor's room, where the device decides when frames are drawn, and back.
import { Vector3 } from 'three';
import type { Manifest } from '../hierarchy/manifest.js';
import type { HierarchyView, Plugin, Stage } from '../scene/hierarchy_view.js';
import { UNITS, unitOfModel } from '../tools/units.js';
import type { ImmersionMode } from './immersion_modes.js';
import { ImmersionSession } from './immersion_session.js';
import type { Shown } from './placement.js';

function shownOf({ box, firstDirection }: HierarchyView, manifest: Manifest): Shown {
  const unit = unitOfModel(manifest);
  const size = Math.max(...box.getSize(new Vector3()).toArray());
  return { centre: box.getCenter(new Vector3()), size, metresPerUnit: unit === null ? null : UNITS[unit].metres, direction: firstDirection };
}

export class Immersion implements Plugin {
  private stage: Stage | null = null;
  private session: ImmersionSession | null = null;
  private isStarting = false;

  constructor(readonly name = 'immersion') {}

  enter(stage: Stage): void {
    this.stage = stage;
  }

  /// Call it when the visitor clicks. Nothing happens without a stage, before `manifest` is there, or twice. Rejects where the visitor or the
  /// browser does not allow it.
  async start(mode: ImmersionMode): Promise<void> {
    const { stage } = this;
    const manifest = stage?.view.manifest ?? null;
    if (stage === null || manifest === null || this.session !== null || this.isStarting) return;
    this.isStarting = true;
    let [isOver, resume] = [false, (): void => undefined];
    const ended = (): void => {
      isOver = true;
      this.session = null;
      resume();
    };
    try {
      const session = await ImmersionSession.start(mode, stage, shownOf(stage.view, manifest), ended);
      if (isOver) return;
      if (this.stage !== stage) { // it was taken away meanwhile
        session.stop();
        return;
      }
      this.session = session;
      resume = stage.suspend();
    } finally {
      this.isStarting = false;
    }
  }

  dispose(): void {
    this.session?.stop();
    this.stage = null;
  }
}
