// SPDX-License-Identifier: MIT
// Where a model stands in the room around a visitor, and how large: metres in the room, the model's units in its world.
import { Matrix4, Quaternion, Vector3 } from 'three';

/// Models whose unit is known stand there in their own size, if that fits a room.
const REAL = { least: 0.05, most: 4 }; // metres
const SHOWN = 1; // metres of the longest side, otherwise
const IN_FRONT = 1.3;
const ABOVE_FLOOR = 1.1;
const UP = new Vector3(0, 1, 0);
const SCALES = { least: 1e-2, most: 1e3 }; // times the first one

export interface Shown {
  /// The middle of the model's box.
  readonly centre: Vector3;
  /// Its longest side, in units.
  readonly size: number;
  /// Null: not known.
  readonly metresPerUnit: number | null;
  /// From where it is looked at first; null: no side is better.
  readonly direction: readonly [number, number, number] | null;
}

function firstScale({ size, metresPerUnit }: Shown): number {
  const real = metresPerUnit === null ? 0 : size * metresPerUnit;
  return metresPerUnit !== null && real >= REAL.least && real <= REAL.most ? metresPerUnit : SHOWN / size;
}

export class Placement {
  /// Metres in the room for one of its units.
  private scale: number;
  /// Radians around the vertical, from the side that is seen first.
  private turned = 0;
  /// Its centre is here, in the room.
  private readonly place: Vector3;
  private readonly first: number;
  private readonly facing: number;

  /// `onFloor`: the room's origin is the floor, not the visitor's head.
  constructor(private readonly shown: Shown, onFloor: boolean) {
    this.first = this.scale = firstScale(shown);
    this.place = new Vector3(0, onFloor ? ABOVE_FLOOR : 0, -IN_FRONT);
    this.facing = shown.direction === null ? 0 : Math.atan2(shown.direction[0], shown.direction[2]);
  }

  get unitsPerMetre(): number {
    return 1 / this.scale;
  }

  move(by: Vector3): void {
    this.place.add(by);
  }

  turn(radians: number): void {
    this.turned += radians;
  }

  /// `factor`: of its size.
  resize(factor: number): void {
    this.scale = Math.min(Math.max(this.scale * factor, SCALES.least * this.first), SCALES.most * this.first);
  }

  /// From the room to the model's world.
  get toWorld(): Matrix4 {
    const units = this.unitsPerMetre;
    const turn = new Quaternion().setFromAxisAngle(UP, this.facing - this.turned);
    const origin = this.place.clone().applyQuaternion(turn).multiplyScalar(-units).add(this.shown.centre);
    return new Matrix4().compose(origin, turn, new Vector3(units, units, units));
  }
}
