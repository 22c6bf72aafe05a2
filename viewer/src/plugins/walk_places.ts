// SPDX-License-Identifier: MIT
// Where somebody can stand in what is drawn, and how far one sees from there.
import { Matrix3, Vector3, type Matrix4 } from 'three';
import type { CameraPose } from '../scene/camera_pose.js';
import type { Stage } from '../scene/hierarchy_view.js';
import { Picker, rayThrough, type Hit } from '../tools/pick.js';
import type { Vector } from '../tools/vectors.js';
import { bodyOf, Walker, type Feet } from '../tools/walker.js';
import type { WalkSpace } from '../tools/walk_space.js';
import { WalkSurface } from '../tools/walk_surface.js';

const FLOOR = 0.6; // the cosine between up and the normal of what one stands on
/// A camera that is so many eye heights above the ground stays where it is.
const NEAR_GROUND = [0.3, 2.5] as const;
/// Directions to look at first, and eye heights from which on a view is open, and beyond which it is long.
const [FACINGS, OPEN, FAR] = [16, 3, 8];
const GRID = 7; // places of the model on a side, where none of the picture is one

export class WalkPlaces {
  walker = new Walker(bodyOf(1));
  /// The height of the eyes.
  private eyes = 1;
  private readonly picker = new Picker();
  private readonly surface: WalkSurface;

  constructor(private readonly stage: Stage) {
    this.surface = new WalkSurface(stage.view, () => this.box.min.y);
  }

  takeEyes(height: number): void {
    this.eyes = height;
    this.walker = new Walker(bodyOf(height));
  }

  /// Since last asked.
  haveTilesChanged(): boolean {
    return this.surface.haveTilesChanged();
  }

  spaceAt(feet: Feet): WalkSpace {
    return this.surface.around(feet, this.eyes);
  }

  /// Below the camera, if the ground is near.
  here({ position: { x, y, z } }: CameraPose): Feet | null {
    const ground = this.spaceAt({ x, y: y - this.eyes, z }).ground({ x, z }, y);
    const height = y - ground;
    if (!(height > NEAR_GROUND[0] * this.eyes && height < NEAR_GROUND[1] * this.eyes)) return null;
    return this.stand({ x, y: ground, z });
  }

  /// On the floor at a place of the picture, or before the wall there, coming from feet that stand already.
  at(right: number, up: number, from: Feet | null): Feet | null {
    const hit = this.pick(right, up);
    if (hit === null) return null;
    const at = this.toWorld(hit.point);
    if (this.isFloor(hit)) return this.stand({ x: at.x, y: at.y, z: at.z });
    return from === null ? null : this.before(at, from);
  }

  /// From the middle of the model outwards, upper floors first.
  anywhere(): Feet | null {
    const { min, max } = this.box;
    const middle = (GRID - 1) / 2;
    const places = Array.from({ length: GRID * GRID }, (_, i) => [i % GRID, Math.floor(i / GRID)] as const)
      .sort((a, b) => Math.hypot(a[0] - middle, a[1] - middle) - Math.hypot(b[0] - middle, b[1] - middle));
    for (const [column, row] of places) {
      const feet = this.inColumn(min.x + ((column + 0.5) / GRID) * (max.x - min.x), min.z + ((row + 0.5) / GRID) * (max.z - min.z), max.y);
      if (feet !== null) return feet;
    }
    return null;
  }

  /// Where one looks first: as the camera did, unless a wall is near there; then where the view is long.
  openYaw({ x, y, z }: Feet, yaw: number): number {
    const { view } = this.stage;
    const toLocal = view.surfaceMatrix.clone().invert();
    const from = new Vector3(x, y + this.eyes, z).applyMatrix4(toLocal).toArray();
    const free = (angle: number): number => {
      const direction = new Vector3(-Math.sin(angle), 0, -Math.cos(angle)).transformDirection(toLocal).toArray();
      return Math.min(this.picker.pick(view.surface, { from, direction })?.distance ?? Infinity, FAR * this.eyes);
    };
    const angles = Array.from({ length: FACINGS }, (_, i) => yaw + (2 * Math.PI * i) / FACINGS);
    const lengths = angles.map(free);
    return lengths[0] >= OPEN * this.eyes ? yaw : angles[lengths.indexOf(Math.max(...lengths))];
  }

  /// Nothing is between the eyes here and there.
  isFree(here: Feet, there: Feet): boolean {
    const { view } = this.stage;
    const toLocal = view.surfaceMatrix.clone().invert();
    const [from, end] = [here, there].map(({ x, y, z }) => new Vector3(x, y + this.eyes, z).applyMatrix4(toLocal).toArray());
    const direction: Vector = [end[0] - from[0], end[1] - from[1], end[2] - from[2]];
    const hit = this.picker.pick(view.surface, { from, direction });
    return hit === null || hit.distance > Math.hypot(...direction);
  }

  /// The floor at a place of the picture, in the world; null: none is seen there.
  floorAt(right: number, up: number): Vector3 | null {
    const hit = this.pick(right, up);
    return hit !== null && this.isFloor(hit) ? this.toWorld(hit.point) : null;
  }

  private get box(): { readonly min: Vector3; readonly max: Vector3 } {
    const { view } = this.stage;
    return view.box.clone().applyMatrix4(view.matrixWorld);
  }

  private stand(feet: Feet): Feet | null {
    return this.walker.stand(this.spaceAt(feet), feet);
  }

  private before(at: Vector3, from: Feet): Feet | null {
    const { radius, step } = this.walker.body;
    const back = new Vector3(from.x - at.x, 0, from.z - at.z);
    const away = back.length();
    if (away < radius) return null;
    at.addScaledVector(back, (1.1 * radius) / away);
    const y = this.spaceAt({ x: at.x, y: from.y, z: at.z }).ground({ x: at.x, z: at.z }, Math.max(at.y, from.y + step));
    return y === -Infinity ? null : this.stand({ x: at.x, y, z: at.z });
  }

  /// On the uppermost floor at a place in plan.
  private inColumn(x: number, z: number, top: number): Feet | null {
    for (let y = top; y > -Infinity; ) {
      const ground = this.spaceAt({ x, y, z }).ground({ x, z }, y);
      const feet = ground === -Infinity ? null : this.stand({ x, y: ground, z });
      if (feet !== null) return feet;
      y = ground - 0.5 * this.eyes;
    }
    return null;
  }

  private pick(right: number, up: number): Hit | null {
    const { stage, stage: { view, camera } } = this;
    const ray = { ...rayThrough(camera, ...(stage.inColumn?.(right, up) ?? [right, up] as const), view.surfaceMatrix), meetsFronts: view.hidesBacks };
    return this.picker.pick(view.surface, ray, (point, values) => view.plugins.keeps(this.toWorld(point), values));
  }

  private toWorld(point: Vector): Vector3 {
    return new Vector3(...point).applyMatrix4(this.stage.view.surfaceMatrix);
  }

  /// Seen from above, whichever side its front is.
  private isFloor({ normal, point }: Hit): boolean {
    const { view, camera } = this.stage;
    const world = new Vector3(...normal).applyNormalMatrix(normalMatrixOf(view.surfaceMatrix));
    return Math.abs(world.normalize().y) > FLOOR && this.toWorld(point).y < camera.matrixWorld.elements[13];
  }
}

function normalMatrixOf(matrix: Readonly<Matrix4>): Matrix3 {
  return new Matrix3().getNormalMatrix(matrix);
}
