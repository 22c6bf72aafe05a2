// SPDX-License-Identifier: MIT
// Somebody walks in the model, at eye height above what is below: up stairs, along walls, never through them.
import { EventDispatcher, Vector3 } from 'three';
import { CameraPose } from '../scene/camera_pose.js';
import type { Plugin, Stage } from '../scene/hierarchy_view.js';
import type { Vector } from '../tools/vectors.js';
import type { Feet } from '../tools/walker.js';
import { attempt } from './attempt.js';
import { EYE_METRES, usualEyes } from './eye_height.js';
import { Overlay, type Mark } from './overlay.js';
import { gamepad, WalkInput } from './walk_input.js';
import { WalkPath, walkTowards } from './walk_path.js';
import { WalkPlaces } from './walk_places.js';
import { Whereabouts } from './whereabouts.js';

/// Eye heights a second, radians a second, eye heights a second squared.
const [SPEED, RUN, TURN, GRAVITY] = [1.1, 2.4, 1.6, 6];
const AHEAD = 3; // eye heights to what the camera looks at
const STEEPEST = 1.45; // radians up and down
const SETTLING = 0.09; // seconds until a third is left of a step's height
const LONGEST = 0.1; // seconds of a frame
const ARRIVING = 2500; // milliseconds
const RING = 24; // sides of the mark
/// Places of the picture where one may stand, the middle first.
const PLACES = [[0, 0], ...[0.15, 0.3, 0.5, 0.7].flatMap((r) => Array.from({ length: 8 }, (_, i) => [r * Math.cos((i * Math.PI) / 4), r * Math.sin((i * Math.PI) / 4)]))] as [number, number][];
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
  private places: WalkPlaces | null = null;
  private overlay: Overlay | null = null;
  private input: WalkInput | null = null;
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
  private whereabouts = new Whereabouts();

  constructor(private readonly options: WalkingOptions = {}) {
    super();
    this.name = options.name ?? 'walking';
  }

  get isWalking(): boolean {
    return this.input !== null;
  }

  /// Units of the world from the feet to the eyes: as given, or 1.6 m where the unit is known, else of the height of rooms.
  get eyeHeight(): number {
    if (this.chosenEyes > 0) return this.chosenEyes;
    return this.stage === null ? EYE_METRES : usualEyes(this.stage.view);
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
    this.places = new WalkPlaces(stage);
    this.whereabouts = new Whereabouts();
    if (this.options.isAlone === false) return;
    this.overlay = new Overlay();
    stage.root.append(this.overlay.root);
  }

  /// Begins where the camera is, if the ground is near; else at the nearest place to the middle of the picture. False: nowhere can one stand.
  start(): boolean {
    const { stage, places } = this;
    if (stage === null || places === null || stage.view.manifest === null) return false;
    if (this.isWalking) return true;
    this.takeEyes(this.eyeHeight);
    places.haveTilesChanged();
    return this.startHere(stage, places) || PLACES.some(([right, up]) => this.startOn(stage, places, places.at(right, up, null))) || this.startOn(stage, places, places.anywhere());
  }

  /// Goes to a place of the picture, from -1 to 1 to the right and up; walking begins there where it has not begun. False: nobody can stand there.
  goTo(right: number, up: number): boolean {
    const { stage, places } = this;
    if (stage === null || places === null || stage.view.manifest === null) return false;
    if (!this.isWalking) {
      this.takeEyes(this.eyeHeight);
      places.haveTilesChanged();
      return this.startOn(stage, places, places.at(right, up, null));
    }
    const to = places.at(right, up, this.feet);
    return to !== null && this.walkTo(places, to);
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
    const { stage, places, hovered } = this;
    const middle = places === null || hovered === null || this.path !== null ? null : places.floorAt(...hovered);
    if (stage === null || places === null || middle === null) return [];
    const toLocal = stage.view.surfaceMatrix.clone().invert();
    const radius = 1.4 * places.walker.body.radius;
    const corners = Array.from({ length: RING + 1 }, (_, i): Vector => {
      const angle = (2 * Math.PI * i) / RING;
      return new Vector3(radius * Math.cos(angle), 0, radius * Math.sin(angle)).add(middle).applyMatrix4(toLocal).toArray();
    });
    return corners.slice(1).map((to, i) => ({ at: corners[i], to }));
  }

  drawn(): void {
    const { stage } = this;
    if (stage === null) return;
    if (this.whereabouts.haveChanged(stage.view.manifest)) this.forget();
    this.overlay?.show(this.isWalking ? this.marks() : [], stage.camera, stage.view.surfaceMatrix);
    if (this.isWalking) this.wake(); // other tiles may be drawn
  }

  dispose(): void {
    this.stop();
    this.overlay?.root.remove();
    this.stage = this.places = this.overlay = null;
  }

  /// One step of the time since the last one; `now`: as performance.now() has it. Called by itself in a browser's frames.
  step(now: number): void {
    const { stage, input, places } = this;
    if (stage === null || places === null || input === null || !this.hasCamera(stage, now)) return;
    const seconds = Math.min(Math.max(now - this.before, 0) / 1000, LONGEST);
    this.before = now;
    const wish = input.wish(now);
    if (!this.isWalking) return; // a button of the gamepad
    if (places.haveTilesChanged() && this.path === null) this.feet = places.walker.again(places.spaceAt(this.feet), this.feet);
    this.look(wish.turnRight * TURN * seconds, wish.lookUp * TURN * seconds);
    const moves = wish.forward !== 0 || wish.right !== 0;
    if (moves) this.path = null;
    if (this.path !== null) this.follow(this.path, now);
    else this.walk(places, wish.forward, wish.right, SPEED * (wish.isRunning ? RUN : 1) * this.eyes * seconds, seconds);
    this.settleEyes(seconds);
    const isElse = this.show(stage);
    if (isElse || moves || this.path !== null || wish.turnRight !== 0 || wish.lookUp !== 0 || gamepad() !== null) this.wake();
  }

  // ---- where one can stand

  private startHere(stage: Stage, places: WalkPlaces): boolean {
    const pose = stage.pose();
    const feet = places.here(pose);
    if (feet === null) return false;
    this.begin(stage, feet, lookingOf(pose));
    if (feet.x === pose.position.x && feet.z === pose.position.z) this.eyeLevel = pose.position.y; // it comes to its height softly
    return true;
  }

  private startOn(stage: Stage, places: WalkPlaces, feet: Feet | null): boolean {
    if (feet === null) return false;
    this.begin(stage, feet, { yaw: places.openYaw(feet, lookingOf(stage.pose()).yaw), pitch: 0 });
    return true;
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

  private walk(places: WalkPlaces, forward: number, right: number, way: number, seconds: number): void {
    const { yaw } = this.looking;
    const long = Math.max(1, Math.hypot(forward, right));
    const [ahead, aside] = [(forward / long) * way, (right / long) * way];
    const by = { x: -Math.sin(yaw) * ahead + Math.cos(yaw) * aside, z: -Math.cos(yaw) * ahead - Math.sin(yaw) * aside };
    const moved = places.walker.move(places.spaceAt(this.feet), this.feet, by);
    this.feet = places.walker.fall(places.spaceAt(moved), moved, seconds, GRAVITY * this.eyes);
  }

  /// On foot where one gets there; where one sees the place, but cannot walk straight there, over what is in the way.
  private walkTo(places: WalkPlaces, to: Feet): boolean {
    const way = walkTowards(places.walker, (feet) => places.spaceAt(feet), this.feet, to);
    const { x, y, z } = way[way.length - 1];
    const { radius, step } = places.walker.body;
    const isThere = Math.hypot(x - to.x, z - to.z) < radius && Math.abs(y - to.y) <= step;
    const chosen = isThere || !places.isFree(this.feet, to) ? way : [this.feet, to];
    if (chosen.length < 2) return false;
    this.path = new WalkPath(chosen, this.eyes);
    this.pathBegan = performance.now();
    this.wake();
    return true;
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
    this.places?.takeEyes(height);
  }

  private forget(): void {
    this.stop();
    this.chosenEyes = 0;
  }
}
