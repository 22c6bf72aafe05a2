// SPDX-License-Identifier: MIT
// A hierarchy in a canvas: light, camera, controls, and frames while there is something new to draw.
import { Box3, NeutralToneMapping, PerspectiveCamera, Scene, Sphere, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { frameWhole } from '../scene/framing.js';
import { areNear } from '../farthest.js';
import { AGAIN, HierarchyProblem } from '../hierarchy/problem.js';
import { CameraPose, type Pose } from '../scene/camera_pose.js';
import { HierarchyView, type Plugin, type Stage } from '../scene/hierarchy_view.js';
import { Lighting } from '../scene/lighting.js';
import { Taps } from '../taps.js';
import { isTyped } from '../typing.js';
import type { ViewOptions } from '../scene/view_options.js';
import { moveByKey } from './keyboard.js';
import { ToldView } from './told_view.js';

const ANGLE = 45; // degrees
const MOST_RATIO = 2;
const POLL = 250; // milliseconds, while something is awaited that draws nothing yet

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

export class ShownModel implements Stage {
  readonly view: HierarchyView;
  readonly surface: HTMLCanvasElement;
  readonly renderer: WebGLRenderer;
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(ANGLE);
  readonly lighting: Lighting;
  private readonly told: ToldView;
  private readonly controls: OrbitControls;
  private readonly sizes = new ResizeObserver(() => { this.wake(); });
  private readonly whole = new Box3();
  private readonly ending = new AbortController();
  private place: Pose | null;
  private readonly taps = new Taps();
  private isSuspended = false;
  private frame = 0;
  private timer = 0;
  private retrying = 0;

  /// `place`: null: all of the model is in the picture. Throws Error where there is no WebGL 2, RangeError for settings out of range.
  constructor(readonly root: ParentNode, url: string, options: ViewOptions, place: Pose | null, private readonly happenings: Happenings) {
    this.place = place;
    this.view = new HierarchyView(url, options);
    this.renderer = this.makeRenderer();
    this.renderer.toneMapping = NeutralToneMapping;
    this.surface = this.renderer.domElement;
    this.lighting = new Lighting(this.scene, this.camera);
    this.told = new ToldView(this, (error) => { this.refuse(error); });
    this.scene.add(this.camera, this.view);
    this.controls = new OrbitControls(this.camera, this.surface);
    this.controls.zoomToCursor = true;
    this.listen();
  }

  /// It is on the page: plug-ins may come.
  enter(): void {
    this.view.plugins.enter(this);
  }

  get signal(): AbortSignal {
    return this.ending.signal;
  }

  use(plugin: Plugin): void {
    this.view.registerPlugin(plugin);
  }

  /// Begins anew with what the host has now; the camera stays.
  reload(): void {
    clearTimeout(this.retrying);
    void this.await(this.view.reload());
  }

  /// Null: all of the model.
  look(place: Pose | null): void {
    this.place = place;
    this.frameAnew();
  }

  /// As a link says, its model left out; '': as the model is seen first.
  show(told: string): void {
    if (this.told.tell(told)) this.frameAnew();
  }

  pose(): CameraPose {
    return new CameraPose(this.camera.position.clone(), this.controls.target.clone());
  }

  jump(pose: CameraPose): void {
    const place = pose.toPose();
    if (areNear([...place.position, ...place.target]) && pose.distance > 0) this.look(place);
  }

  /// There is no way that is seen.
  fly(pose: CameraPose): void {
    this.jump(pose);
  }

  travel(pose: CameraPose): number {
    this.jump(pose);
    return 0;
  }

  redraw(): void {
    this.wake();
  }

  suspend(): () => void {
    this.isSuspended = true;
    return () => {
      this.isSuspended = false;
      this.wake();
    };
  }

  readonly wake = (): void => {
    clearTimeout(this.timer);
    if (this.frame === 0 && !this.signal.aborted) this.frame = requestAnimationFrame((now) => { this.draw(now); });
  };

  dispose(): void {
    this.ending.abort();
    cancelAnimationFrame(this.frame);
    clearTimeout(this.timer);
    clearTimeout(this.retrying);
    this.sizes.disconnect();
    this.controls.dispose();
    this.view.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.surface.remove();
  }

  private makeRenderer(): WebGLRenderer {
    try {
      return new WebGLRenderer({ antialias: true, alpha: true, stencil: true });
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
    this.surface.addEventListener('keydown', (event) => { this.press(event); });
    this.surface.addEventListener('pointerdown', (event) => { this.taps.down(event); });
    this.surface.addEventListener('pointermove', (event) => { this.taps.move(event); });
    this.surface.addEventListener('pointercancel', (event) => { this.taps.cancel(event); });
    this.surface.addEventListener('pointerup', (event) => { this.lift(event); });
    this.surface.addEventListener('webglcontextrestored', this.wake);
    this.sizes.observe(this.surface);
  }

  private begin(): void {
    if (this.signal.aborted) return;
    this.told.apply();
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
    if (this.signal.aborted) return;
    if (error instanceof HierarchyProblem && error.mayPass) this.retrying = setTimeout(() => { this.reload(); }, AGAIN) as unknown as number;
    this.happenings.problem(error instanceof Error ? error.message : String(error));
  }

  /// From now on the camera is the user's.
  private take(): void {
    this.place = this.pose().toPose();
  }

  private press(event: KeyboardEvent): void {
    if (isTyped(event) || !moveByKey(this.camera, this.controls.target, event)) return;
    event.preventDefault();
    this.take();
    this.controls.update();
    this.happenings.moved();
    this.wake();
  }

  /// Places of the picture are from -1 to 1.
  private lift(event: PointerEvent): void {
    if (!this.taps.lift(event)) return;
    const { clientX, clientY } = event;
    const { left, top, width, height } = this.surface.getBoundingClientRect();
    this.view.plugins.tapped(((clientX - left) / width) * 2 - 1, 1 - ((clientY - top) / height) * 2);
  }

  private draw(now: number): void {
    this.frame = 0;
    if (this.isSuspended || !this.fit()) return;
    if (this.told.greet()) this.frameAnew();
    this.aim();
    const news = this.view.update(this.camera, this.renderer.domElement, now);
    this.view.draw(this.renderer, this.scene, this.camera);
    if (news) this.wake();
    else if (!this.view.stats().settled) this.timer = setTimeout(this.wake, POLL) as unknown as number;
  }

  /// As large as on the page. False: it has no size.
  private fit(): boolean {
    const { clientWidth: width, clientHeight: height } = this.surface;
    if (width === 0 || height === 0) return false;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, MOST_RATIO));
    const { width: before, height: beforeHeight } = this.surface;
    const ratio = this.renderer.getPixelRatio();
    if (before !== Math.floor(width * ratio) || beforeHeight !== Math.floor(height * ratio)) this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    return true;
  }

  /// The next frame begins where the camera belongs.
  private frameAnew(): void {
    this.whole.makeEmpty();
    this.wake();
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
    const place = this.place ?? this.told.place();
    if (place !== null) {
      this.camera.position.set(...place.position);
      this.controls.target.set(...place.target);
    } else if (!this.whole.isEmpty()) {
      const { position, target } = frameWhole(this.view.shape(), this.whole, this.view.firstDirection, (ANGLE * Math.PI) / 180, this.camera.aspect);
      this.controls.target.copy(target);
      this.camera.position.copy(position);
    }
    this.controls.update();
  }
}
