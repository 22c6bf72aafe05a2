// SPDX-License-Identifier: MIT
// A camera's place and the point that it looks at.
import { Vector3 } from 'three';

export type Triple = readonly [number, number, number];

/// A pose in the world, in numbers.
export interface Pose {
  readonly position: Triple;
  readonly target: Triple;
}

/// A pose with vectors: nothing changes them, and neither should you.
export class CameraPose {
  constructor(
    readonly position: Vector3,
    readonly target: Vector3,
  ) {}

  static from({ position, target }: Pose): CameraPose {
    return new CameraPose(new Vector3(...position), new Vector3(...target));
  }

  toPose(): Pose {
    const { position: p, target: t } = this;
    return { position: [p.x, p.y, p.z], target: [t.x, t.y, t.z] };
  }

  get distance(): number {
    return this.position.distanceTo(this.target);
  }

  /// The direction of the view, of length 1.
  get forward(): Vector3 {
    return this.target.clone().sub(this.position).normalize();
  }

  equals(other: CameraPose): boolean {
    return this.position.equals(other.position) && this.target.equals(other.target);
  }
}
