// SPDX-License-Identifier: MIT
// What draws: canvas, scene, camera and light.
import { Box3, Group, NeutralToneMapping, PerspectiveCamera, Raycaster, Scene, Vector2, Vector3, WebGLRenderer, type Object3D } from 'three';
import { words } from '../words/words.js';
import { partDrawer } from '../../src/tools/draw_part.js';
import type { DrawPart, PictureSize } from '../../src/tools/screenshot.js';
import type { CameraPose } from '../../src/scene/camera_pose.js';
import { depthRange, VIEW_ANGLE } from './camera_moves.js';
import { Lighting } from '../../src/scene/lighting.js';
import type { Occlusion } from './occlusion.js';

const MOST_RATIO = 2;

/// Draws the scene in its own way.
export interface Painter {
  paint(renderer: WebGLRenderer, scene: Scene, camera: PerspectiveCamera): void;
  /// Whether a point of the world is drawn.
  keeps(point: Vector3): boolean;
}

function makeRenderer(): WebGLRenderer {
  try {
    return new WebGLRenderer({ antialias: true, alpha: true, stencil: true, powerPreference: 'high-performance' });
  } catch {
    throw new Error(words.problems.noWebGl);
  }
}

export class Stage {
  readonly camera = new PerspectiveCamera((VIEW_ANGLE * 180) / Math.PI, 1);
  readonly canvas: HTMLCanvasElement;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly shown = new Group();
  readonly lighting = new Lighting(this.scene, this.camera);
  private readonly raycaster = new Raycaster();
  /// Null: as large as the canvas.
  asked: PictureSize | null = null;
  /// Null: as it is.
  painter: Painter | null = null;
  private isOccluded = false;
  private occlusion: Occlusion | null = null;
  private distance = 1;
  private nominal = new Vector2();
  private sharpness = 1;

  /// Throws Error where there is no WebGL 2.
  constructor() {
    this.renderer = makeRenderer();
    this.renderer.setClearAlpha(0);
    this.renderer.toneMapping = NeutralToneMapping;
    this.canvas = this.renderer.domElement;
    this.scene.add(this.camera, this.shown);
  }

  /// Whether hollows get less light, from the next frame on. True: that was so once code had come, which may be rejected.
  async setOccluded(is: boolean): Promise<boolean> {
    this.isOccluded = is;
    if (!is) this.dropOcclusion();
    if (!is || this.occlusion !== null) return false;
    const { Occlusion } = await import('./occlusion.js');
    if (this.isOccluded) this.occlusion ??= new Occlusion(this.scene, this.camera); // it may have been switched off meanwhile
    return true;
  }

  /// What a session in the visitor's room draws with.
  get parts(): { readonly renderer: WebGLRenderer; readonly scene: Scene; readonly camera: PerspectiveCamera } {
    const { renderer, scene, camera } = this;
    return { renderer, scene, camera };
  }

  show(object: Object3D): void {
    this.shown.add(object);
  }

  /// Of the canvas.
  get aspect(): number {
    return this.nominal.x / Math.max(this.nominal.y, 1);
  }

  /// Pixels of a picture of full sharpness.
  get size(): { width: number; height: number } {
    return this.asked ?? { width: this.nominal.x, height: this.nominal.y };
  }

  /// Takes over the size that the canvas has on the page, with a part of the pixels on each axis. False: nothing has changed.
  fit(sharpness: number): boolean {
    const { clientWidth, clientHeight } = this.canvas;
    if (clientWidth === 0 || clientHeight === 0) return false;
    const ratio = Math.min(devicePixelRatio, MOST_RATIO);
    const nominal = new Vector2(clientWidth, clientHeight).multiplyScalar(ratio).floor();
    if (this.nominal.equals(nominal) && this.sharpness === sharpness) return false;
    this.nominal = nominal;
    this.sharpness = sharpness;
    this.renderer.setPixelRatio(ratio * sharpness);
    this.renderer.setSize(clientWidth, clientHeight, false);
    return true;
  }

  aim(pose: CameraPose, box: Box3): void {
    this.camera.position.copy(pose.position);
    this.camera.lookAt(pose.target);
    this.distance = pose.distance;
    this.camera.aspect = this.asked ? this.asked.width / this.asked.height : this.aspect;
    Object.assign(this.camera, depthRange(pose, box));
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }

  draw(): void {
    if (this.painter) this.painter.paint(this.renderer, this.scene, this.camera);
    else this.drawScene();
  }

  /// Of a picture as it is aimed at.
  get drawPart(): DrawPart {
    return partDrawer(this.renderer, this.camera, () => { this.draw(); });
  }

  /// The point of the drawn triangles at a place of the picture, from -1 to 1.
  pick(right: number, up: number): Vector3 | null {
    this.raycaster.setFromCamera(new Vector2(right, up), this.camera);
    const hits = this.raycaster.intersectObject(this.shown, true);
    return hits.find(({ point }) => this.painter?.keeps(point) ?? true)?.point ?? null;
  }

  /// A part of a larger picture does not know what lies beside it: there hollows are as they are.
  private drawScene(): void {
    this.renderer.render(this.scene, this.camera);
    if (this.camera.view?.enabled !== true) this.occlusion?.shade(this.renderer, this.distance, Math.min(devicePixelRatio, MOST_RATIO));
  }

  private dropOcclusion(): void {
    this.occlusion?.dispose();
    this.occlusion = null;
  }

  dispose(): void {
    this.isOccluded = false;
    this.dropOcclusion();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.canvas.remove();
  }
}
