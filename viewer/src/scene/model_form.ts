// SPDX-License-Identifier: MIT
// Facts about a mesh, from the root tile and then from the manifest: its box, its outline, how it stands.
import { Box3, Vector3 } from 'three';
import type { Vector } from '../cut/viewpoint.js';
import { directionOf } from '../hierarchy/first_view.js';
import type { Manifest } from '../hierarchy/manifest.js';
import type { Tile } from '../hierarchy/tile.js';
import { silhouetteOf } from './silhouette.js';
import { upwards, type Standing } from './standing.js';
import { terrainOf, type Terrain } from './terrain.js';
import type { TileScene } from './tile_scene.js';

function saysColour({ colours }: Tile): boolean {
  return colours?.some((value) => value < 255) ?? false;
}

/// A fact that is null is not known yet.
export class ModelForm {
  /// The mesh's box, upright.
  readonly box = new Box3();
  root: Tile | null = null;
  /// The mesh as a terrain, as it stands; null also if it is none.
  terrain: Terrain | null = null;
  /// x, y, z of points of its outline, in the tiles' coordinates.
  silhouette: Float32Array = new Float32Array(0);
  /// In the tiles' coordinates: smallest, then largest.
  private corners: readonly number[] = [];

  constructor(private readonly tiles: TileScene) {}

  takeRoot(root: Tile, standing: Standing): void {
    this.root = root;
    this.silhouette = silhouetteOf(root);
    this.tiles.insideOut = root.insideOut;
    this.corners = root.box;
    this.stand(standing);
  }

  /// It knows the box better than the root.
  takeManifest({ source, origin, place }: Manifest): void {
    const corner = (from: readonly number[]): number[] => from.map((x, axis) => x - origin[axis] - place[axis]);
    this.corners = [...corner(source.min), ...corner(source.max)];
    this.setBox();
  }

  /// Stands the mesh upright, as it is wished.
  stand(standing: Standing): void {
    const { root } = this;
    if (root === null) return;
    const up = upwards(standing.up, root.zUp);
    this.terrain = terrainOf(root, up);
    this.tiles.stand(standing, root, this.terrain?.along ?? up);
    this.setBox();
  }

  /// Which way is up, in the tiles' coordinates.
  upwards({ up }: Standing): Vector {
    return upwards(up, this.root?.zUp ?? false);
  }

  /// Null: an older hierarchy does not say it, or the mesh stands on another axis, too.
  firstDirection({ up }: Standing): Vector | null {
    const { root } = this;
    if (root?.firstView == null) return null;
    return up === 'file' || up === (root.zUp ? 'z' : 'y') ? directionOf(root.firstView) : null;
  }

  /// Points of the outline, upright, in one and the same vector.
  *shape(): Iterable<Vector3> {
    const point = new Vector3();
    for (let i = 0; i < this.silhouette.length; i += 3) yield point.fromArray(this.silhouette, i).applyMatrix4(this.tiles.matrix);
  }

  /// Colours that are white everywhere say nothing.
  get hasColours(): boolean | null {
    return this.root && (this.root.picture !== null || saysColour(this.root));
  }

  get hasAttributes(): boolean | null {
    return this.root && this.root.values !== null;
  }

  get hasTriangles(): boolean | null {
    return this.root && this.root.indices.length > 0;
  }

  private setBox(): void {
    const [a, b, c, d, e, f] = this.corners;
    this.box.set(new Vector3(a, b, c), new Vector3(d, e, f)).applyMatrix4(this.tiles.matrix);
  }
}
