// SPDX-License-Identifier: MIT
// A hierarchy in a canvas: light, camera, controls, and frames while there is something new to draw.
import { Box3, NeutralToneMapping, PerspectiveCamera, Scene, Sphere, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { axesOf, frameShape } from '../scene/framing.js';
import { HierarchyProblem } from '../hierarchy/problem.js';
import { HierarchyView } from '../scene/hierarchy_view.js';
import { keyOf, Lighting } from '../scene/lighting.js';
import { rigFor, shownLook } from '../scene/shown_look.js';
import { isTyped } from '../typing.js';
import type { ViewOptions } from '../scene/view_options.js';
import type { CameraPlace } from './camera_attribute.js';
import { moveByKey } from './keyboard.js';

const ANGLE = 45; // degrees
const MOST_RATIO = 2;
const POLL = 250; // milliseconds, while something is awaited that draws nothing yet
const AGAIN = 20_000; // milliseconds until a host that did not answer is asked again
const MARGIN = 1.08;
const FIRST_DIRECTION = new Vector3(0.5, 0.3, 1).normalize();

export interface Happenings {
  opened(): void;
  /// `message`: in plain words.
  problem(message: string): void;
  recovered(): void;
  /// The host has another model by now.
  replaced(): void;
  /// The user has moved the camera.
  moved(): void;
}

export class ShownModel {
  readonly view: HierarchyView;
  readonly canvas: HTMLCanvasElement;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(ANGLE);
  private readonly lighting: Lighting;
  private readonly controls: OrbitControls;
  private readonly sizes = new ResizeObserver(() => { this.wake(); });
  private readonly whole = new Box3();
  private place: CameraPlace | null;
  private frame = 0;
  private timer = 0;
  private retrying = 0;
  private ended = false;

  /// `place`: null: all of the model is in the picture. Throws Error where there is no WebGL 2, RangeError for settings out of range.
  constructor(url: string, options: ViewOptions, place: CameraPlace | null, private readonly happenings: Happenings) {
    this.place = place;
    this.view = new HierarchyView(url, options);
    this.renderer = this.makeRenderer();
    this.renderer.toneMapping = NeutralToneMapping;
    this.canvas = this.renderer.domElement;
    this.lighting = new Lighting(this.scene, this.camera);
    this.scene.add(this.camera, this.view);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.zoomToCursor = true;
    this.listen();
  }

  /// Begins anew with what the host has now; the camera stays.
  reload(): void {
    clearTimeout(this.retrying);
    void this.await(this.view.reload());
  }

  /// Null: all of the model.
  look(place: CameraPlace | null): void {
    this.place = place;
    this.whole.makeEmpty();
    this.wake();
  }

  get shownFrom(): CameraPlace {
    return { position: this.camera.position.toArray(), target: this.controls.target.toArray() };
  }

  readonly wake = (): void => {
    clearTimeout(this.timer);
    if (this.frame === 0 && !this.ended) this.frame = requestAnimationFrame((now) => { this.draw(now); });
  };

  dispose(): void {
    this.ended = true;
    cancelAnimationFrame(this.frame);
    clearTimeout(this.timer);
    clearTimeout(this.retrying);
    this.sizes.disconnect();
    this.controls.dispose();
    this.view.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.canvas.remove();
  }

  private makeRenderer(): WebGLRenderer {
    try {
      return new WebGLRenderer({ antialias: true, alpha: true });
    } catch {
      this.view.dispose();
      throw new Error('This browser has no WebGL 2, which models are drawn with.');
    }
  }

  private listen(): void {
    this.view.addEventListener('change', this.wake);
    this.view.addEventListener('problem', ({ message }) => { this.happenings.problem(message); });
    this.view.addEventListener('recovered', () => { this.happenings.recovered(); });
    this.view.addEventListener('replaced', () => { this.happenings.replaced(); });
    void this.await(this.view.opened);
    this.controls.addEventListener('change', this.wake);
    this.controls.addEventListener('start', () => { this.take(); });
    this.controls.addEventListener('end', () => { this.happenings.moved(); });
    this.canvas.addEventListener('keydown', (event) => { this.press(event); });
    this.canvas.addEventListener('webglcontextrestored', this.wake);
    this.sizes.observe(this.canvas);
  }

  private begin(): void {
    if (this.ended) return;
    const rig = rigFor(this.view);
    this.lighting.set(rig, keyOf(rig));
    this.view.setLook(shownLook(this.view.look, rig, 1, this.view));
    this.happenings.opened();
    this.wake();
  }

  private async await(opened: Promise<void>): Promise<void> {
    try {
      await opened;
      this.begin();
    } catch (error) {
      this.refuse(error);
    }
  }

  /// A host that may be back is asked again.
  private refuse(error: unknown): void {
    if (this.ended) return;
    if (error instanceof HierarchyProblem && error.mayPass) this.retrying = setTimeout(() => { this.reload(); }, AGAIN) as unknown as number;
    this.happenings.problem(error instanceof Error ? error.message : String(error));
  }

  /// From now on the camera is the user's.
  private take(): void {
    this.place = this.shownFrom;
  }

  private press(event: KeyboardEvent): void {
    if (isTyped(event) || !moveByKey(this.camera, this.controls.target, event)) return;
    event.preventDefault();
    this.take();
    this.controls.update();
    this.happenings.moved();
    this.wake();
  }

  private draw(now: number): void {
    this.frame = 0;
    if (!this.fit()) return;
    this.aim();
    const news = this.view.update(this.camera, this.renderer.domElement, now);
    this.renderer.render(this.scene, this.camera);
    if (news) this.wake();
    else if (!this.view.stats().settled) this.timer = setTimeout(this.wake, POLL) as unknown as number;
  }

  /// As large as on the page. False: it has no size.
  private fit(): boolean {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return false;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, MOST_RATIO));
    const { width: before, height: beforeHeight } = this.canvas;
    const ratio = this.renderer.getPixelRatio();
    if (before !== Math.floor(width * ratio) || beforeHeight !== Math.floor(height * ratio)) this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    return true;
  }

  private aim(): void {
    if (!this.whole.equals(this.view.box)) this.frameAll();
    const radius = this.view.box.isEmpty() ? 1 : this.view.box.getBoundingSphere(new Sphere()).radius;
    const away = this.camera.position.distanceTo(this.view.box.getCenter(new Vector3()));
    this.camera.near = Math.max(away - radius * 1.05, this.camera.position.distanceTo(this.controls.target) * 0.02);
    this.camera.far = Math.max(away + radius * 1.05, this.camera.near * 2);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }

  /// The box is another one: that of the manifest is better than the root's.
  private frameAll(): void {
    this.whole.copy(this.view.box);
    if (this.place !== null) {
      this.camera.position.set(...this.place.position);
      this.controls.target.set(...this.place.target);
    } else if (!this.whole.isEmpty()) {
      const { firstDirection } = this.view;
      const back = firstDirection === null ? FIRST_DIRECTION : new Vector3(...firstDirection);
      const slope = Math.tan((ANGLE * Math.PI) / 360) / MARGIN;
      const { position, target } = frameShape(this.view.shape(), this.whole, axesOf(back.clone().negate()), { across: slope * this.camera.aspect, upwards: slope });
      this.controls.target.copy(target);
      this.camera.position.copy(position);
    }
    this.controls.update();
  }
}
