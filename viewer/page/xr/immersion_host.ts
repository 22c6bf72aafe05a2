// SPDX-License-Identifier: MIT
// Takes a view into the visitor's room, where the device decides when frames are drawn, and back; the code is loaded when that is asked for.
import { Vector3 } from 'three';
import type { HierarchyView, Manifest } from '../../src/index.js';
import { UNITS, unitOfModel } from '../../src/tools/units.js';
import type { Stage } from '../view/stage.js';
import type { Immersion, ImmersionMode } from './immersion.js';
import type { Shown } from './placement.js';

export interface ImmersionSurroundings {
  readonly stage: Stage;
  readonly view: HierarchyView;
  /// The page draws again.
  ended(): void;
  /// It is not allowed, or the code could not be loaded.
  failed(why: string): void;
}

function shownOf({ box, firstDirection }: HierarchyView, manifest: Manifest): Shown {
  const unit = unitOfModel(manifest);
  const size = Math.max(...box.getSize(new Vector3()).toArray());
  return { centre: box.getCenter(new Vector3()), size, metresPerUnit: unit === null ? null : UNITS[unit].metres, direction: firstDirection };
}

export class ImmersionHost {
  private immersion: Immersion | null = null;
  private isStarting = false;

  constructor(private readonly around: ImmersionSurroundings) {}

  /// The device draws.
  get isOn(): boolean {
    return this.immersion !== null;
  }

  async start(mode: ImmersionMode): Promise<void> {
    const { stage, view } = this.around;
    if (this.isOn || this.isStarting || view.manifest === null) return;
    this.isStarting = true;
    try {
      const { Immersion } = await import('./immersion.js');
      this.immersion = await Immersion.start(mode, { ...stage.parts, view, shown: shownOf(view, view.manifest), ended: () => { this.end(); } });
    } catch (error) {
      this.around.failed(error instanceof Error ? error.message : String(error));
    } finally {
      this.isStarting = false;
    }
  }

  stop(): void {
    this.immersion?.stop();
  }

  private end(): void {
    this.immersion = null;
    this.around.ended();
  }
}
