// SPDX-License-Identifier: MIT
// Between the input's coordinates and the world of the picture, however the model stands.
import { Vector3 } from 'three';
import type { Manifest } from '../hierarchy/manifest.js';
import type { HierarchyView } from '../scene/hierarchy_view.js';
import { Coordinates } from './coordinates.js';
import type { Vector } from './vectors.js';

export class Places {
  /// They hold as long as this is the view's.
  readonly manifest: Manifest;
  private readonly coordinates: Coordinates;

  constructor(private readonly view: Pick<HierarchyView, 'manifest' | 'surfaceMatrix'>) {
    this.manifest = view.manifest!;
    this.coordinates = new Coordinates(this.manifest);
  }

  /// In the tiles' coordinates.
  toLocal(at: Vector): Vector {
    return this.coordinates.fromInput(at);
  }

  toWorld(at: Vector): Vector3 {
    return new Vector3(...this.toLocal(at)).applyMatrix4(this.view.surfaceMatrix);
  }

  toInput(point: Vector3): Vector {
    return this.coordinates.toInput(point.clone().applyMatrix4(this.view.surfaceMatrix.clone().invert()).toArray());
  }
}
