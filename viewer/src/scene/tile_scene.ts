// SPDX-License-Identifier: MIT
// The tiles of a cut in a three scene, joined along their seams.
import { Group, type Camera, type Material, type Scene, type Side, type WebGLRenderer } from 'three';
import type { ChosenNode } from '../cut/choose_cut.js';
import type { ResidentTile } from '../cut/tile_store.js';
import type { Vector } from '../cut/viewpoint.js';
import type { ScalarAttribute } from '../hierarchy/scalar_values.js';
import type { Tile } from '../hierarchy/tile.js';
import { keyOf, type Node } from '../hierarchy/tree.js';
import { ContextWatch } from './context_watch.js';
import { errorColour, partitionColour, sharedMaterials, sideOf, type SharedMaterials } from './materials.js';
import type { Omits } from './omission.js';
import type { Look } from './settings.js';
import { Shadings, type Shading } from './shading.js';
import type { DrawnTile } from './surface.js';
import { uprightRows, type Standing } from './standing.js';
import { heightsOf } from './terrain.js';
import { TileObject } from './tile_object.js';
import { TilePrograms } from './tile_programs.js';
import { Uploads } from './uploads.js';

export class TileScene extends Group {
  private readonly objects = new Map<number, TileObject>();
  private cut: ReadonlyMap<number, Tile> = new Map();
  private look: Look | null = null;
  private attributes: readonly ScalarAttribute[] = [];
  private readonly damaged: Node[] = [];
  private readonly told = new Set<number>();
  private readonly materials: SharedMaterials;
  private readonly contexts: ContextWatch;
  private readonly uploads = new Uploads();
  private readonly programs = new TilePrograms();
  private renderer: WebGLRenderer | null = null; // that has drawn a tile
  /// Some tiles have normal maps, and others have none.
  hasNormalMaps = false;

  /// `restored`: a lost device is back, without the pictures that only it had. `changed`: tiles are to be shown anew.
  constructor(restored: () => void, changed: () => void) {
    super();
    this.materials = sharedMaterials(new Shadings(() => {
      this.look = null;
      changed();
    }));
    this.contexts = new ContextWatch(() => { this.leaveDevice(); }, restored);
  }

  /// The whole model's triangles show their backs to the outside.
  set insideOut(is: boolean) {
    this.materials.outwards.value = is ? -1 : 1;
  }

  /// Backs are not drawn, from the next cut on.
  set hidesBacks(hides: boolean) {
    this.materials.hidesBacks.value = hides;
    this.look = null;
  }

  get side(): Side {
    return sideOf(this.materials);
  }

  /// Those of plug-ins, from the next cut on.
  set shadings(shadings: readonly Shading[]) {
    this.materials.shadings.all = shadings;
    this.look = null;
  }

  /// `root`: whose heights count, along the direction `along`.
  stand(standing: Standing, root: Tile, along: Vector): void {
    const [[a, b, c], [d, e, f], [g, h, i]] = uprightRows(standing, root.zUp);
    this.materials.upwards.value.set(...along);
    this.materials.heights.value.set(...heightsOf(root, along));
    this.matrixAutoUpdate = false;
    this.matrix.set(a, b, c, 0, d, e, f, 0, g, h, i, 0, 0, 0, 0, 1);
    this.matrixWorldNeedsUpdate = true;
  }

  /// A tile has come. Where tiles were drawn before its pictures go to the GPU first.
  take(resident: ResidentTile, look: Look): void {
    const { picture, normalMap } = resident.tile;
    if (this.renderer === null || (picture === null && normalMap === null)) return;
    const object = this.make(resident, look);
    object.visible = false;
    this.uploads.add(resident.key, object.textures);
  }

  /// True while the pictures of a tile are still to go to the GPU.
  awaits(key: number): boolean {
    return this.uploads.awaits(key);
  }

  /// Brings pictures to the GPU, as many as go in a frame. Returns whether there are more.
  upload(isMoving: boolean): boolean {
    return this.renderer !== null && this.uploads.step(this.renderer, isMoving);
  }

  /// Resolves once tiles with normal maps and without can be drawn at once.
  get compiled(): Promise<unknown> {
    return this.programs.compiled;
  }

  /// Shows a cut instead of the one before; true if that changes the picture. `attributes`: of the model.
  show(residents: readonly ResidentTile[], look: Look, attributes: readonly ScalarAttribute[] = []): boolean {
    const isSameCut = residents.length === this.cut.size && residents.every(({ key, tile }) => this.cut.get(key) === tile);
    if (isSameCut && look === this.look && attributes === this.attributes) return false;
    this.attributes = attributes;
    this.materials.shadings.show(look, attributes);
    for (const material of this.partMaterials) this.materials.shadings.leaveOut(material);
    this.cut = new Map(residents.map(({ key, tile }) => [key, tile]));
    this.look = look;
    for (const key of this.objects.keys()) if (!this.cut.has(key)) this.hide(key);
    for (const resident of residents) this.join(resident, look);
    return true;
  }

  /// Draw wires and points.
  private get partMaterials(): readonly Material[] {
    const { wires, points, dots } = this.materials;
    return [wires, points, dots.plain, dots.coloured];
  }

  private hide(key: number): void {
    const object = this.objects.get(key);
    if (object?.visible) object.hide();
  }

  private join(resident: ResidentTile, look: Look): void {
    const object = this.objects.get(resident.key) ?? this.make(resident, look);
    const changed = resident.seam.look(this.cut);
    if (changed || !object.isResolved) object.resolve();
    object.setLook(look);
    if (resident.seam.isDamaged) this.tellDamaged(resident.node);
    object.visible = true;
  }

  private make(resident: ResidentTile, look: Look): TileObject {
    const object = new TileObject(resident, look, this.materials);
    object.onBeforeRender = (renderer, scene, camera) => { this.drawnBy(renderer, scene, camera, object); };
    this.objects.set(resident.key, object);
    this.add(object);
    return object;
  }

  private drawnBy(renderer: WebGLRenderer, scene: Scene, camera: Camera, object: TileObject): void {
    this.renderer = renderer;
    this.contexts.drawnOn(renderer.domElement);
    if (this.hasNormalMaps) this.programs.drawn(object, renderer, scene, camera);
  }

  /// While the device is lost: the one that comes back is not to be told to delete what it never had.
  private leaveDevice(): void {
    for (const object of this.objects.values()) object.leaveDevice();
  }

  /// The tile is no longer in memory.
  drop({ key }: ResidentTile): void {
    this.uploads.forget(key);
    this.objects.get(key)?.dispose();
    this.objects.delete(key);
  }

  private tellDamaged(node: Node): void {
    const key = keyOf(node.level, node.index);
    if (this.told.has(key)) return;
    this.told.add(key);
    this.damaged.push(node);
  }

  /// Tiles whose seams turned out to be damaged since last asked; each once.
  takeDamaged(): Node[] {
    return this.damaged.splice(0);
  }

  /// Colours whole tiles, where the look says so.
  paint(drawn: readonly ChosenNode[], look: Look, threshold: number): void {
    for (const { key, node, pixels } of drawn) {
      const object = this.objects.get(key);
      if (look.colours === 'partition') object?.paint(partitionColour(node.level, node.index));
      if (look.colours === 'error') object?.paint(errorColour(pixels, threshold));
    }
  }

  /// What is left out of tiles; null: nothing is.
  get omits(): Omits | null {
    return this.materials.shadings.omits;
  }

  get omissionKey(): string {
    return this.materials.shadings.omissionKey;
  }

  /// Makes a material leave out the same.
  leaveOut(material: Material): void {
    this.materials.shadings.leaveOut(material);
  }

  drawn(): DrawnTile[] {
    return [...this.objects.values()].filter(({ visible }) => visible).map((object) => object.drawn());
  }

  trianglesOf(key: number): number {
    return this.objects.get(key)?.triangles ?? 0;
  }

  dispose(): void {
    this.contexts.stop();
    this.programs.forget();
    for (const object of this.objects.values()) object.dispose();
    this.objects.clear();
    for (const material of this.partMaterials) material.dispose();
    this.materials.matcap.dispose();
  }
}
