// SPDX-License-Identifier: MIT
// Draws: canvas, scene, camera and light.
import { Matrix4, NeutralToneMapping, Raycaster, Scene, Vector2, WebGLRenderer, type Box3, type Vector3 } from 'three';
import { words } from '../words/words.js';
import { partDrawer } from '../../src/tools/draw_part.js';
import type { DrawPart, PictureSize } from '../../src/tools/screenshot.js';
import type { CameraPose } from '../../src/scene/camera_pose.js';
import { axesOf } from '../../src/scene/framing.js';
import { heightAt, SwitchingCamera, type Projection } from '../../src/scene/projection.js';
import { depthRange, parallelStand, VIEW_ANGLE } from './camera_moves.js';
import type { HierarchyView } from '../../src/index.js';
import type { Partner } from './partner.js';
import { Lighting } from '../../src/scene/lighting.js';
import { drawnHit } from '../../src/scene/drawn_hits.js';

const MOST_RATIO = 2;

function makeRenderer(): WebGLRenderer {
  try {
    return new WebGLRenderer({ antialias: true, alpha: true, stencil: true, powerPreference: 'high-performance' });
  } catch {
    throw new Error(words.problems.noWebGl);
  }
}

/// Upright; a camera that looks straight down has the back of the model above.
function face(camera: SwitchingCamera, pose: CameraPose): void {
  camera.lookAt(pose.target);
  const { right, up, forward } = axesOf(pose.forward);
  if (forward.x === 0 && forward.z === 0) camera.quaternion.setFromRotationMatrix(new Matrix4().makeBasis(right, up, forward.negate()));
}

export class Canvas {
  readonly camera = new SwitchingCamera((VIEW_ANGLE * 180) / Math.PI, 1);
  readonly element: HTMLCanvasElement;
  readonly renderer: WebGLRenderer;
  readonly scene = new Scene();
  readonly lighting = new Lighting(this.scene, this.camera);
  private readonly raycaster = new Raycaster();
  /// Null: as large as the canvas.
  asked: PictureSize | null = null;
  /// Another model is in the picture, too.
  partner: Partner | null = null;
  private aimed: { readonly pose: CameraPose; readonly projection: Projection } | null = null;
  private isStale = false;
  private nominal = new Vector2();
  private sharpness = 1;
  readonly view: HierarchyView;

  /// Throws Error where there is no WebGL 2: then no view is made.
  constructor(makeView: () => HierarchyView) {
    this.renderer = makeRenderer();
    this.view = makeView();
    this.renderer.setClearAlpha(0);
    this.renderer.toneMapping = NeutralToneMapping;
    this.element = this.renderer.domElement;
    this.scene.add(this.camera, this.view);
  }

  get aspect(): number {
    return this.nominal.x / this.columns / Math.max(this.nominal.y, 1);
  }

  private get columns(): number {
    return this.partner?.columns ?? 1;
  }

  /// Holds all that is in the picture.
  get box(): Box3 {
    return this.partner?.box ?? this.view.box;
  }

  shape(): Iterable<Vector3> {
    return this.partner?.shape() ?? this.view.shape();
  }

  /// Pixels of a column of full sharpness.
  get size(): { width: number; height: number } {
    const { width, height } = this.asked ?? { width: this.nominal.x, height: this.nominal.y };
    return { width: width / this.columns, height };
  }

  /// A place of the picture, within the column that it lies in.
  inColumn(right: number, up: number): readonly [number, number] {
    return this.partner?.inColumn(right, up) ?? [right, up];
  }

  /// As HierarchyView.update().
  update(now: number): boolean {
    return this.partner?.update(this.size, now) ?? this.view.update(this.camera, this.size, now);
  }

  /// The next fit() is one of another size, as after another number of columns.
  fitAgain(): void {
    this.isStale = true;
  }

  /// Takes over the size that the canvas has on the page, with a part of the pixels on each axis. False: nothing has changed.
  fit(sharpness: number): boolean {
    const { clientWidth, clientHeight } = this.element;
    if (clientWidth === 0 || clientHeight === 0) return false;
    const ratio = Math.min(devicePixelRatio, MOST_RATIO);
    const nominal = new Vector2(clientWidth, clientHeight).multiplyScalar(ratio).floor();
    if (this.nominal.equals(nominal) && this.sharpness === sharpness && !this.isStale) return false;
    this.isStale = false;
    this.nominal = nominal;
    this.sharpness = sharpness;
    this.renderer.setPixelRatio(ratio * sharpness);
    this.renderer.setSize(clientWidth, clientHeight, false);
    return true;
  }

  /// `angle`: radians from the lower to the upper edge of the picture.
  aim(pose: CameraPose, box: Box3, { projection = 'perspective', angle = VIEW_ANGLE }: { projection?: Projection; angle?: number } = {}): void {
    this.aimed = { pose, projection };
    this.camera.fov = (angle * 180) / Math.PI;
    this.camera.parallelHeight = projection === 'parallel' ? heightAt(pose.distance, VIEW_ANGLE) : null;
    this.camera.aspect = this.asked ? this.asked.width / this.columns / this.asked.height : this.aspect;
    this.stand(box);
    face(this.camera, pose);
    this.updateCamera();
  }

  /// The camera sees as far as this box, from where it is aimed.
  reach(box: Box3): void {
    this.stand(box);
    this.updateCamera();
  }

  private stand(box: Box3): void {
    if (this.aimed === null) return;
    const { pose, projection } = this.aimed;
    const { position, near, far } = projection === 'parallel' ? parallelStand(pose, box) : { position: pose.position, ...depthRange(pose, box) };
    this.camera.position.copy(position);
    Object.assign(this.camera, { near, far });
  }

  private updateCamera(): void {
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }

  draw(): void {
    if (this.partner === null) this.view.draw(this.renderer, this.scene, this.camera);
    else {
      this.partner.paint();
      this.view.plugins.drawn(this);
      this.partner.drawn();
    }
  }

  /// Draws parts of a picture as it is aimed at.
  get drawPart(): DrawPart {
    return partDrawer(this.renderer, this.camera, () => {
      if (this.partner === null) this.view.plugins.paint(this);
      else this.partner.paint();
    });
  }

  /// The point of the drawn triangles at a place of a column, from -1 to 1.
  pick(right: number, up: number): Vector3 | null {
    if (this.partner !== null) return this.partner.pick(right, up);
    this.raycaster.setFromCamera(new Vector2(right, up), this.camera);
    return drawnHit(this.raycaster, this.view)?.point ?? null;
  }

  dispose(): void {
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.element.remove();
  }
}
