// SPDX-License-Identifier: MIT
// Somebody walks in the model, at eye height above what is below: up stairs, along walls, never through them.
import { EventDispatcher, Matrix3, Vector3, type Matrix4 } from 'three';
import { CameraPose } from '../scene/camera_pose.js';
import type { HierarchyView, Plugin, Stage } from '../scene/hierarchy_view.js';
import { Picker, rayThrough, type Hit } from '../tools/pick.js';
import { storeysOf } from '../tools/storeys.js';
import { UNITS, unitOfModel } from '../tools/units.js';
import type { Vector } from '../tools/vectors.js';
import { bodyOf, Walker, type Feet } from '../tools/walker.js';
import type { WalkSpace } from '../tools/walk_space.js';
import { WalkSurface } from '../tools/walk_surface.js';
import { attempt } from './attempt.js';
import { Overlay, type Mark } from './overlay.js';
import { gamepad, WalkInput } from './walk_input.js';
import { WalkPath, walkTowards } from './walk_path.js';
import { Whereabouts } from './whereabouts.js';

const EYE_METRES = 1.6;
const EYE_OF_ROOM = 0.64; // of its height
const EYE_OF_MODEL = 0.02; // of its diagonal, where nothing is known
const MOST_OF_MODEL = 0.25; // of its longest side: then the unit is wrong, or the model is a toy
/// Eye heights a second, radians a second, eye heights a second squared.
const [SPEED, RUN, TURN, GRAVITY] = [1.1, 2.4, 1.6, 6];
const AHEAD = 3; // eye heights to what the camera looks at
const STEEPEST = 1.45; // radians up and down
const SETTLING = 0.09; // seconds until a third is left of a step's height
const LONGEST = 0.1; // seconds of a frame
const FLOOR = 0.6; // the cosine between up and the normal of what one stands on
/// A camera that is so many eye heights above the ground stays where it is.
const NEAR_GROUND = [0.3, 2.5] as const;
const ARRIVING = 2500; // milliseconds
const RING = 24; // sides of the mark
/// Places of the picture where one may stand, the middle first.
const PLACES = [[0, 0], ...[0.15, 0.3, 0.5, 0.7].flatMap((r) => Array.from({ length: 8 }, (_, i) => [r * Math.cos((i * Math.PI) / 4), r * Math.sin((i * Math.PI) / 4)]))] as [number, number][];
/// Directions to look at first, and eye heights beyond which a view is long.
const [FACINGS, FAR] = [16, 8];
const GRID = 7; // places of the model on a side, where none of the picture is one

export interface WalkingOptions {
  /// False: taps that nobody else wants are no way to go, and nothing is marked over the picture; `goTo` and `marks` are yours to call.
  isAlone?: boolean;
  /// Another one than `walking`.
  name?: string;
}

interface Looking {
  /// Radians to the left, from north, which is away along z, and up.
  yaw: number;
  pitch: number;
}

function lookingOf({ forward }: CameraPose): Looking {
  return { yaw: Math.atan2(-forward.x, -forward.z), pitch: Math.asin(Math.min(Math.max(forward.y, -1), 1)) };
}

function wantsStill(): boolean {
  return (globalThis.matchMedia as typeof globalThis.matchMedia | undefined)?.('(prefers-reduced-motion: reduce)').matches ?? false;
}

/// Event `change`: walking has begun or ended, or eyes are at another height.
export class Walking extends EventDispatcher<{ change: object }> implements Plugin {
  readonly name: string;
  private stage: Stage | null = null;
  private surface: WalkSurface | null = null;
  private readonly picker = new Picker();
  private overlay: Overlay | null = null;
  private input: WalkInput | null = null;
  private walker = new Walker(bodyOf(1));
  private eyes = 0;
  private chosenEyes = 0;
  private feet: Feet = { x: 0, y: 0, z: 0 };
  private eyeLevel = 0;
  private looking: Looking = { yaw: 0, pitch: 0 };
  private path: WalkPath | null = null;
  private pathBegan = 0;
  private before = 0;
  private frame = 0;
  private shown: CameraPose | null = null;
  private arrivesUntil = 0;
  private hovered: readonly [number, number] | null = null;
  private places = new Whereabouts();

  constructor(private readonly options: WalkingOptions = {}) {
    super();
    this.name = options.name ?? 'walking';
  }

  get isWalking(): boolean {
    return this.input !== null;
  }

  /// Units of the world from the feet to the eyes: as given, or 1.6 m where the unit is known, else of the height of rooms.
  get eyeHeight(): number {
    return this.chosenEyes > 0 ? this.chosenEyes : this.usualEyes();
  }

  set eyeHeight(height: number) {
    if (!(height > 0 && height < Infinity)) throw new RangeError(`an eye height is above 0, not ${height}`);
    this.chosenEyes = height;
    this.takeEyes(height);
    this.dispatchEvent({ type: 'change' });
    this.wake();
  }

  enter(stage: Stage): void {
    this.stage = stage;
    this.surface = new WalkSurface(stage.view, () => stage.view.box.clone().applyMatrix4(stage.view.matrixWorld).min.y);
    this.places = new Whereabouts();
    if (this.options.isAlone === false) return;
    this.overlay = new Overlay();
    stage.root.append(this.overlay.root);
  }

  /// Begins where the camera is, if the ground is near; else at the nearest place to the middle of the picture. False: nowhere can one stand.
  start(): boolean {
    const { stage } = this;
    if (stage === null || stage.view.manifest === null) return false;
    if (this.isWalking) return true;
    this.takeEyes(this.eyeHeight);
    return this.startHere(stage) || PLACES.some(([right, up]) => this.startAt(right, up)) || this.startAnywhere(stage);
  }

  /// Goes to a place of the picture, from -1 to 1 to the right and up; walking begins there where it has not begun. False: nobody can stand there.
  goTo(right: number, up: number): boolean {
    if (!this.isWalking) {
      if (this.stage === null || this.stage.view.manifest === null) return false;
      this.takeEyes(this.eyeHeight);
      return this.startAt(right, up);
    }
    const to = this.standAt(right, up);
    return to !== null && this.walkTo(to);
  }

  /// The camera stays where it is.
  stop(): void {
    if (!this.isWalking) return;
    this.input?.stop();
    this.input = this.path = this.shown = this.hovered = null;
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    this.dispatchEvent({ type: 'change' });
    this.stage?.redraw();
  }

  tapped(right: number, up: number): boolean {
    return this.isWalking && this.goTo(right, up);
  }

  /// Where one would stand: a ring around the place under the mouse.
  marks(): readonly Mark[] {
    const { stage, hovered } = this;
    const hit = stage === null || hovered === null || this.path !== null ? null : this.pick(...hovered);
    if (stage === null || hit === null || !this.isFloor(hit)) return [];
    const toLocal = stage.view.surfaceMatrix.clone().invert();
    const middle = this.toWorld(hit.point);
    const corners = Array.from({ length: RING + 1 }, (_, i): Vector => {
      const angle = (2 * Math.PI * i) / RING;
      const radius = 1.4 * this.walker.body.radius;
      return new Vector3(radius * Math.cos(angle), 0, radius * Math.sin(angle)).add(middle).applyMatrix4(toLocal).toArray();
    });
    return corners.slice(1).map((to, i) => ({ at: corners[i], to }));
  }

  drawn(): void {
    const { stage } = this;
    if (stage === null) return;
    if (this.places.haveChanged(stage.view.manifest)) this.forget();
    this.overlay?.show(this.isWalking ? this.marks() : [], stage.camera, stage.view.surfaceMatrix);
    if (this.isWalking) this.wake(); // other tiles may be drawn
  }

  dispose(): void {
    this.stop();
    this.overlay?.root.remove();
    this.stage = this.surface = this.overlay = null;
  }

  /// One step of the time since the last one; `now`: as performance.now() has it. Called by itself in a browser's frames.
  step(now: number): void {
    const { stage, input } = this;
    if (stage === null || input === null || !this.hasCamera(stage, now)) return;
    const seconds = Math.min(Math.max(now - this.before, 0) / 1000, LONGEST);
    this.before = now;
    const wish = input.wish(now);
    if (!this.isWalking) return; // a button of the gamepad
    if (this.surface!.haveTilesChanged() && this.path === null) this.feet = this.walker.again(this.spaceAt(this.feet), this.feet);
    this.look(wish.turnRight * TURN * seconds, wish.lookUp * TURN * seconds);
    const moves = wish.forward !== 0 || wish.right !== 0;
    if (moves) this.path = null;
    if (this.path !== null) this.follow(this.path, now);
    else this.walk(wish.forward, wish.right, SPEED * (wish.isRunning ? RUN : 1) * this.eyes * seconds, seconds);
    this.settleEyes(seconds);
    const isElse = this.show(stage);
    if (isElse || moves || this.path !== null || wish.turnRight !== 0 || wish.lookUp !== 0 || gamepad() !== null) this.wake();
  }

  // ---- where one can stand

  private startHere(stage: Stage): boolean {
    const pose = stage.pose();
    const { x, y, z } = pose.position;
    this.surface!.haveTilesChanged();
    const ground = this.spaceAt({ x, y: y - this.eyes, z }).ground({ x, z }, y);
    const height = y - ground;
    if (!(height > NEAR_GROUND[0] * this.eyes && height < NEAR_GROUND[1] * this.eyes)) return false;
    const feet = this.walker.stand(this.spaceAt({ x, y: ground, z }), { x, y: ground, z });
    if (feet === null) return false;
    this.begin(stage, feet, lookingOf(pose));
    if (feet.x === x && feet.z === z) this.eyeLevel = y; // it comes to its height softly
    return true;
  }

  private startAt(right: number, up: number): boolean {
    const { stage } = this;
    if (stage === null) return false;
    this.surface!.haveTilesChanged();
    const feet = this.standAt(right, up);
    if (feet === null) return false;
    this.begin(stage, feet, { yaw: this.openYaw(feet, lookingOf(stage.pose()).yaw), pitch: 0 });
    return true;
  }

  /// Where one looks first: as the camera did, unless a wall is near there; then where the view is long.
  private openYaw({ x, y, z }: Feet, yaw: number): number {
    const { view } = this.stage!;
    const toLocal = view.surfaceMatrix.clone().invert();
    const from = new Vector3(x, y + this.eyes, z).applyMatrix4(toLocal).toArray();
    const free = (angle: number): number => {
      const direction = new Vector3(-Math.sin(angle), 0, -Math.cos(angle)).transformDirection(toLocal).toArray();
      return Math.min(this.picker.pick(view.surface, { from, direction })?.distance ?? Infinity, FAR * this.eyes);
    };
    const angles = Array.from({ length: FACINGS }, (_, i) => yaw + (2 * Math.PI * i) / FACINGS);
    const lengths = angles.map(free);
    return lengths[0] >= AHEAD * this.eyes ? yaw : angles[lengths.indexOf(Math.max(...lengths))];
  }

  /// From the middle of the model outwards, upper floors first.
  private startAnywhere(stage: Stage): boolean {
    const { min, max } = stage.view.box.clone().applyMatrix4(stage.view.matrixWorld);
    const middle = (GRID - 1) / 2;
    const places = Array.from({ length: GRID * GRID }, (_, i) => [i % GRID, Math.floor(i / GRID)] as const)
      .sort((a, b) => Math.hypot(a[0] - middle, a[1] - middle) - Math.hypot(b[0] - middle, b[1] - middle));
    return places.some(([column, row]) => {
      const place = { x: min.x + ((column + 0.5) / GRID) * (max.x - min.x), z: min.z + ((row + 0.5) / GRID) * (max.z - min.z) };
      for (let y = max.y; y > -Infinity; ) {
        const ground = this.spaceAt({ ...place, y }).ground(place, y);
        const feet = ground === -Infinity ? null : this.walker.stand(this.spaceAt({ ...place, y: ground }), { ...place, y: ground });
        if (feet !== null) {
          this.begin(stage, feet, { yaw: this.openYaw(feet, lookingOf(stage.pose()).yaw), pitch: 0 });
          return true;
        }
        y = ground - 0.5 * this.eyes;
      }
      return false;
    });
  }

  /// On the floor at a place of the picture, or before the wall there.
  private standAt(right: number, up: number): Feet | null {
    const hit = this.pick(right, up);
    if (hit === null) return null;
    const at = this.toWorld(hit.point);
    if (this.isFloor(hit)) return this.walker.stand(this.spaceAt({ x: at.x, y: at.y, z: at.z }), { x: at.x, y: at.y, z: at.z });
    if (!this.isWalking) return null;
    const back = new Vector3(this.feet.x - at.x, 0, this.feet.z - at.z);
    const away = back.length();
    if (away < this.walker.body.radius) return null;
    at.addScaledVector(back, (1.1 * this.walker.body.radius) / away);
    const y = this.spaceAt({ x: at.x, y: this.feet.y, z: at.z }).ground({ x: at.x, z: at.z }, Math.max(at.y, this.feet.y + this.walker.body.step));
    return y === -Infinity ? null : this.walker.stand(this.spaceAt({ x: at.x, y, z: at.z }), { x: at.x, y, z: at.z });
  }

  private pick(right: number, up: number): Hit | null {
    const { stage } = this;
    const { view, camera } = stage!;
    const ray = { ...rayThrough(camera, ...(stage!.inColumn?.(right, up) ?? [right, up] as const), view.surfaceMatrix), meetsFronts: view.hidesBacks };
    return this.picker.pick(view.surface, ray, (point, values) => view.plugins.keeps(this.toWorld(point), values));
  }

  private toWorld(point: Vector): Vector3 {
    return new Vector3(...point).applyMatrix4(this.stage!.view.surfaceMatrix);
  }

  /// Seen from above, whichever side its front is.
  private isFloor({ normal, point }: Hit): boolean {
    const { view, camera } = this.stage!;
    const world = new Vector3(...normal).applyNormalMatrix(normalMatrixOf(view.surfaceMatrix));
    return Math.abs(world.normalize().y) > FLOOR && this.toWorld(point).y < camera.matrixWorld.elements[13];
  }

  private spaceAt(feet: Feet): WalkSpace {
    return this.surface!.around(feet, this.eyes);
  }

  // ---- moving

  private begin(stage: Stage, feet: Feet, looking: Looking): void {
    this.feet = feet;
    this.looking = { yaw: looking.yaw, pitch: Math.min(Math.max(looking.pitch, -STEEPEST), STEEPEST) };
    this.eyeLevel = feet.y + this.eyes;
    this.before = performance.now();
    this.input = new WalkInput(stage, {
      wake: () => { this.wake(); },
      drag: (right, up) => { this.drag(right, up); },
      tap: (right, up) => { if (!stage.view.plugins.tapped(right, up)) this.goTo(right, up); },
      hover: (place) => { this.hover(place); },
      leave: () => { this.stop(); },
    });
    stage.surface.focus({ preventScroll: true });
    this.shown = this.pose();
    this.arrivesUntil = this.before + ARRIVING;
    stage.fly(this.shown);
    this.dispatchEvent({ type: 'change' });
    this.wake();
  }

  /// False: it is on its way to where walking begins, or somebody else has moved it: then walking ends.
  private hasCamera(stage: Stage, now: number): boolean {
    const isThere = this.shown === null || stage.pose().position.distanceTo(this.shown.position) + stage.pose().target.distanceTo(this.shown.target) < 1e-4 * this.eyes;
    if (isThere) this.arrivesUntil = 0;
    else if (now < this.arrivesUntil) this.wake();
    else this.stop();
    return isThere;
  }

  private walk(forward: number, right: number, way: number, seconds: number): void {
    const { yaw } = this.looking;
    const long = Math.max(1, Math.hypot(forward, right));
    const [ahead, aside] = [(forward / long) * way, (right / long) * way];
    const by = { x: -Math.sin(yaw) * ahead + Math.cos(yaw) * aside, z: -Math.cos(yaw) * ahead - Math.sin(yaw) * aside };
    const space = this.spaceAt(this.feet);
    const moved = this.walker.move(space, this.feet, by);
    this.feet = this.walker.fall(this.spaceAt(moved), moved, seconds, GRAVITY * this.eyes);
  }

  /// On foot where one gets there; where one sees the place, but cannot walk straight there, over what is in the way.
  private walkTo(to: Feet): boolean {
    const way = walkTowards(this.walker, (feet) => this.spaceAt(feet), this.feet, to);
    const { x, y, z } = way[way.length - 1];
    const { radius, step } = this.walker.body;
    const isThere = Math.hypot(x - to.x, z - to.z) < radius && Math.abs(y - to.y) <= step;
    const chosen = isThere || !this.isFree(to) ? way : [this.feet, to];
    if (chosen.length < 2) return false;
    this.path = new WalkPath(chosen, this.eyes);
    this.pathBegan = performance.now();
    this.wake();
    return true;
  }

  /// Nothing is between the eyes here and there.
  private isFree(to: Feet): boolean {
    const { view } = this.stage!;
    const toLocal = view.surfaceMatrix.clone().invert();
    const [from, end] = [this.feet, to].map(({ x, y, z }) => new Vector3(x, y + this.eyes, z).applyMatrix4(toLocal).toArray());
    const direction: Vector = [end[0] - from[0], end[1] - from[1], end[2] - from[2]];
    const hit = this.picker.pick(view.surface, { from, direction });
    return hit === null || hit.distance > Math.hypot(...direction);
  }

  private follow(path: WalkPath, now: number): void {
    const feet = wantsStill() ? null : path.at((now - this.pathBegan) / 1000);
    this.feet = feet ?? path.end;
    if (feet === null) this.path = null;
  }

  private settleEyes(seconds: number): void {
    const level = this.feet.y + this.eyes;
    const left = (this.eyeLevel - level) * Math.exp(-seconds / SETTLING);
    this.eyeLevel = wantsStill() || Math.abs(left) < 1e-4 * this.eyes ? level : level + left;
  }

  /// True: the camera is elsewhere.
  private show(stage: Stage): boolean {
    const pose = this.pose();
    if (this.shown?.equals(pose) === true) return false;
    this.shown = pose;
    stage.jump(pose);
    return true;
  }

  private pose(): CameraPose {
    const { yaw, pitch } = this.looking;
    const eye = new Vector3(this.feet.x, this.eyeLevel, this.feet.z);
    const ahead = new Vector3(-Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch), -Math.cos(yaw) * Math.cos(pitch));
    return new CameraPose(eye, ahead.multiplyScalar(AHEAD * this.eyes).add(eye));
  }

  /// What is under the pointer stays there.
  private drag(right: number, up: number): void {
    const { camera } = this.stage!;
    const angle = 'fov' in camera ? (camera.fov * Math.PI) / 180 : Math.PI / 4;
    this.look(-right * angle, -up * angle);
    this.wake();
  }

  private look(right: number, up: number): void {
    this.looking.yaw -= right;
    this.looking.pitch = Math.min(Math.max(this.looking.pitch + up, -STEEPEST), STEEPEST);
  }

  private hover(place: readonly [number, number] | null): void {
    this.hovered = place;
    this.stage?.redraw();
  }

  private wake(): void {
    if (this.frame !== 0 || !this.isWalking) return;
    this.frame = requestAnimationFrame((now) => {
      this.frame = 0;
      attempt(() => { this.step(now); }, () => { this.stop(); });
    });
  }

  // ---- how tall one is

  private takeEyes(height: number): void {
    this.eyes = height;
    this.walker = new Walker(bodyOf(height));
  }

  private usualEyes(): number {
    const view = this.stage?.view;
    if (view === undefined) return EYE_METRES;
    const size = view.box.getSize(new Vector3());
    const usual = knownEyes(view);
    return usual !== null && usual < MOST_OF_MODEL * Math.max(size.x, size.y, size.z) ? usual : EYE_OF_MODEL * size.length() || 1;
  }

  private forget(): void {
    this.stop();
    this.chosenEyes = 0;
  }
}

function normalMatrixOf(matrix: Readonly<Matrix4>): Matrix3 {
  return new Matrix3().getNormalMatrix(matrix);
}

/// Null: neither the unit nor the height of rooms is known.
function knownEyes({ manifest, root, upwards, standing }: HierarchyView): number | null {
  const unit = manifest && unitOfModel(manifest);
  const metres = unit === null ? null : UNITS[unit].metres;
  if (metres !== null) return EYE_METRES / metres;
  const storeys = root === null ? [] : storeysOf(root, upwards);
  if (storeys.length === 0) return null;
  const heights = storeys.map(({ floor, ceiling }) => ceiling - floor).sort((a, b) => a - b);
  return EYE_OF_ROOM * standing.stretch * heights[Math.floor(heights.length / 2)];
}
