// SPDX-License-Identifier: MIT
// A model in a cell of the gallery: its root tile, shaded, turned as its outline is. Comes with the view's code.
import { MathUtils, Matrix4, NeutralToneMapping, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from 'three';
import TileWorker from '../../src/hierarchy/tile_worker.js?worker';
import { HierarchyView } from '../../src/index.js';
import { linkOf, writeLink } from '../../src/view/view_link.js';
import { DEFAULT_APPEARANCE, withChoices } from '../appearance.js';
import { DISTANCE, fitAt, fitMatrix, FOCUS, towardsViewer, type Turn } from '../gallery/layout.js';
import type { Shape } from '../gallery/shape.js';
import { Lighting } from '../../src/scene/lighting.js';
import { Presentation } from './presentation.js';

const MOST_RATIO = 2;
/// Nothing but the root is refined to.
const ROOT_ONLY = { threshold: 1000, restDetail: 1 };

export class RootPicture {
  readonly canvas: HTMLCanvasElement;
  private readonly renderer = new WebGLRenderer({ antialias: true, alpha: true });
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera();
  private readonly view: HierarchyView;
  private readonly presentation: Presentation;
  private opened = false;
  private frame = 0;

  /// `url`: of the hierarchy; `shape`: its outline; without lines its box tells how large the model is. `drawn`: after the first picture. Throws where there is no WebGL 2.
  constructor(url: string, private readonly shape: Shape, private turn: Turn, private readonly drawn: () => void) {
    this.canvas = this.renderer.domElement;
    this.canvas.className = 'cell-solid';
    this.canvas.setAttribute('aria-hidden', 'true');
    this.renderer.toneMapping = NeutralToneMapping;
    this.view = new HierarchyView(url, { createWorker: () => new TileWorker(), workers: 1, settings: ROOT_ONLY });
    this.presentation = new Presentation(this.view, new Lighting(this.scene, this.camera), DEFAULT_APPEARANCE);
    this.scene.add(this.camera, this.view);
    this.view.addEventListener('change', () => { this.ask(); });
    this.view.opened.then(() => { this.begin(); }, () => undefined); // the outline stays
  }

  show(turn: Turn): void {
    this.turn = turn;
    this.ask();
  }

  close(): void {
    cancelAnimationFrame(this.frame);
    this.opened = false;
    this.view.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.canvas.remove();
  }

  private begin(): void {
    this.opened = true;
    this.ask();
  }

  private ask(): void {
    if (this.frame === 0 && this.opened) this.frame = requestAnimationFrame((now) => { this.draw(now); });
  }

  private draw(now: number): void {
    this.frame = 0;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!this.opened || width === 0 || height === 0) return;
    this.present();
    this.fit(width, height);
    this.aim(width / height);
    this.view.update(this.camera, { width, height }, now);
    this.renderer.render(this.scene, this.camera);
    this.drawn();
  }

  /// What the model is may choose for it, and its first view; but it stands as its outline does.
  private present(): void {
    const { manifest } = this.view;
    if (manifest !== null) this.presentation.chosen = withChoices(linkOf(writeLink(manifest.view), 'look'), DEFAULT_APPEARANCE);
    this.presentation.apply();
  }

  private fit(width: number, height: number): void {
    const ratio = Math.min(devicePixelRatio, MOST_RATIO);
    if (this.canvas.width === Math.floor(width * ratio) && this.canvas.height === Math.floor(height * ratio)) return;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
  }

  /// As layout.ts sees the outline.
  private aim(aspect: number): void {
    const { camera, view, turn } = this;
    const { ends, ball, first, fit } = this.shape;
    const radius = ends.length > 0 ? ball.radius : view.box.getSize(new Vector3()).length() / 2 || 1;
    camera.fov = MathUtils.radToDeg(2 * Math.atan(1 / (FOCUS * Math.min(aspect, 1))));
    Object.assign(camera, { aspect, near: (DISTANCE - 1) * radius * 0.9, far: (DISTANCE + 1) * radius * 1.1 });
    // Around the model, as the sun stays where it is.
    camera.position.set(...towardsViewer(turn)).multiplyScalar(DISTANCE * radius);
    camera.lookAt(0, 0, 0);
    camera.updateProjectionMatrix();
    camera.projectionMatrix.premultiply(new Matrix4().fromArray(fitMatrix(fitAt(fit, first, turn), aspect)));
    camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
    view.position.copy(view.box.getCenter(new Vector3())).negate();
    this.scene.updateMatrixWorld();
  }
}
