// SPDX-License-Identifier: MIT
// A model in the room around a visitor, through WebXR: it refines for what the headset sees, within the device's frame rate.
import { Group, MathUtils, PerspectiveCamera, Vector3, type Quaternion } from 'three';
import type { Stage } from '../scene/hierarchy_view.js';
import { Hands } from './hands.js';
import type { ImmersionMode } from './immersion_modes.js';
import { Placement, type Shown } from './placement.js';

const NEAR = 0.03; // metres
const FAR = 200;
const USUAL_RATE = 72; // frames per second, of a device that does not say
const WIDER = 1.15; // than one eye sees, that both do

async function floorOf(session: XRSession): Promise<'local-floor' | 'local'> {
  return session.requestReferenceSpace('local-floor').then(() => 'local-floor' as const, () => 'local' as const);
}

export class ImmersionSession {
  private readonly rig = new Group();
  private readonly eyes = new PerspectiveCamera(50, 1, NEAR, FAR);
  /// Sees what both eyes see, in the model's units.
  private readonly head = new PerspectiveCamera();
  private readonly hands: Hands;
  private readonly rate: number;
  /// The stage's camera as it stood before.
  private readonly before: { readonly position: Vector3; readonly quaternion: Quaternion };

  private constructor(private readonly session: XRSession, private readonly stage: Stage, private readonly placement: Placement) {
    const { view, scene, camera } = stage;
    this.hands = new Hands(placement);
    this.rate = view.settings.framesPerSecond;
    this.before = { position: camera.position.clone(), quaternion: camera.quaternion.clone() };
    this.rig.matrixAutoUpdate = false;
    this.rig.add(this.eyes);
    scene.add(this.rig);
    view.setSettings({ framesPerSecond: Math.min(Math.max(session.frameRate ?? USUAL_RATE, 1), 240) });
  }

  /// Call it when the visitor clicks: `ended` is called once the visitor is back. Lights may be at the stage's camera: it follows the
  /// visitor's head. Rejects where the visitor or the browser does not allow it.
  static async start(mode: ImmersionMode, stage: Stage, shown: Shown, ended: () => void): Promise<ImmersionSession> {
    const session = await navigator.xr!.requestSession(mode, { optionalFeatures: ['local-floor'] });
    const space = await floorOf(session);
    const { renderer } = stage;
    renderer.xr.enabled = true;
    renderer.xr.setReferenceSpaceType(space);
    const immersion = new ImmersionSession(session, stage, new Placement(shown, space === 'local-floor'));
    session.addEventListener('end', () => {
      immersion.end();
      ended();
    });
    await renderer.xr.setSession(session);
    renderer.setAnimationLoop((now, frame?: XRFrame) => { if (frame) immersion.draw(now, frame); });
    return immersion;
  }

  stop(): void {
    this.session.end().catch(() => undefined); // it has ended by itself
  }

  private draw(now: number, frame: XRFrame): void {
    const { renderer, scene, view, camera } = this.stage;
    const space = renderer.xr.getReferenceSpace();
    if (space !== null) this.hands.step(frame, space, now);
    this.rig.matrix.copy(this.placement.toWorld);
    this.rig.updateMatrixWorld(true);
    const size = this.aimHead();
    if (size !== null) {
      camera.position.copy(this.head.position);
      camera.quaternion.copy(this.head.quaternion);
      camera.updateMatrixWorld(true);
      view.update(this.head, size, now);
    }
    renderer.render(scene, this.eyes);
  }

  /// Pixels of an eye; null: the device does not know where it is.
  private aimHead(): { width: number; height: number } | null {
    const { cameras } = this.stage.renderer.xr.getCamera();
    const eye = cameras.at(0);
    const viewport = eye?.viewport;
    if (eye === undefined || viewport === undefined || viewport.w === 0) return null;
    const units = this.placement.unitsPerMetre;
    const world = this.rig.matrix.clone().multiply(eye.matrix);
    world.decompose(this.head.position, this.head.quaternion, new Vector3());
    const { elements: e } = eye.projectionMatrix;
    Object.assign(this.head, { fov: MathUtils.RAD2DEG * 2 * Math.atan(WIDER / e[5]), aspect: e[5] / e[0], near: NEAR * units, far: FAR * units });
    this.head.updateProjectionMatrix();
    this.head.updateMatrixWorld();
    // As large as its part of what the wider one sees.
    return { width: viewport.z * WIDER, height: viewport.w * WIDER };
  }

  private end(): void {
    const { renderer, scene, view, camera } = this.stage;
    renderer.setAnimationLoop(null);
    renderer.xr.enabled = false;
    scene.remove(this.rig);
    camera.position.copy(this.before.position);
    camera.quaternion.copy(this.before.quaternion);
    view.setSettings({ framesPerSecond: this.rate });
  }
}
