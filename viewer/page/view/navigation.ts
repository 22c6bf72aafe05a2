// SPDX-License-Identifier: MIT
// Where the camera is, and all that moves it: gestures, keys and flights.
import { Box3, Vector3 } from 'three';
import { areNear } from '../../src/farthest.js';
import { CameraPose } from '../../src/scene/camera_pose.js';
import type { Projection } from '../../src/scene/projection.js';
import { depthOf, pan, retarget, slide, turn, wholeView, zoom } from './camera_moves.js';
import { Flight } from './flight.js';
import { Glide, type Moves } from './glide.js';

/// The point of the drawn surface at a place of the picture, from -1 to 1 to the right and up. Null: there is none.
export type Pick = (right: number, up: number) => Vector3 | null;

const FARTHEST = 12; // whole views
const NEAREST = 1e-5; // of a whole view: closer, single precision shows
const CLOSER = 0.3; // of the distance, after a double click
const LONGEST_FRAME = 100; // milliseconds

const still = matchMedia('(prefers-reduced-motion: reduce)');

export interface Framing {
  readonly aspect: number;
  readonly projection?: Projection;
  readonly direction: Parameters<typeof wholeView>[2];
  readonly points?: Iterable<Vector3>;
  /// The model is seen first so instead; null: all of it.
  readonly first?: CameraPose | null;
}

export class Navigation {
  private stand: CameraPose;
  private readonly glide = new Glide();
  private flight: Flight | null = null;
  private grabbed: Vector3 | null = null;
  private before = 0;
  private seen: CameraPose | null = null;
  private whole: CameraPose;
  private home: CameraPose;
  private aspect = 1;
  private projection: Projection = 'perspective';
  private box = new Box3(new Vector3(-1, -1, -1), new Vector3(1, 1, 1));

  /// `wake`: a frame is wanted.
  constructor(
    private readonly pick: Pick,
    private readonly wake: () => void,
  ) {
    this.whole = this.home = wholeView(this.box, 1);
    this.stand = this.home;
  }

  /// Always numbers: what none can come of leaves the camera where it is.
  get pose(): CameraPose {
    return this.stand;
  }

  set pose(pose: CameraPose) {
    if (areNear([...pose.position, ...pose.target])) this.stand = pose;
  }

  get atHome(): boolean {
    return this.pose.equals(this.home);
  }

  get busy(): boolean {
    return this.flight !== null || this.glide.busy;
  }

  /// The model's box, the picture's aspect and projection, and from where the whole is seen, as wholeView() has it; what shows the whole goes on
  /// showing the whole.
  frame(box: Box3, { aspect, projection = 'perspective', direction, points = [], first = null }: Framing): void {
    const follow = this.atHome;
    this.box = box.clone();
    this.aspect = aspect;
    this.projection = projection;
    this.whole = wholeView(this.box, aspect, direction, points, projection);
    this.home = first ?? this.whole;
    if (follow) this.jump(this.home);
  }

  jump(pose: CameraPose): void {
    this.stop();
    this.pose = pose;
    this.wake();
  }

  fly(pose: CameraPose): void {
    this.start(Flight.straight(this.pose, pose), pose);
  }

  /// As stories go from place to place. Returns the milliseconds that it takes.
  travel(pose: CameraPose): number {
    const flight = Flight.overview(this.pose, pose);
    this.start(flight, pose);
    return still.matches ? 0 : flight.milliseconds;
  }

  /// To the first view of the model.
  goHome(): void {
    this.fly(this.home);
  }

  /// The same; from there to all of it.
  goHomeOrOut(): void {
    this.fly(this.atHome ? this.whole : this.home);
  }

  /// Flies to the surface at a place of the picture, if there is any.
  approach(right: number, up: number): void {
    const point = this.pick(right, up);
    if (point === null) return;
    const away = this.isParallel ? this.pose.distance : point.distanceTo(this.pose.position);
    const distance = Math.max(away * CLOSER, this.whole.distance * NEAREST);
    this.fly(new CameraPose(this.pose.forward.multiplyScalar(-distance).add(point), point));
  }

  /// A gesture begins at a place of the picture: what lies there stays under the pointer.
  grab(right: number, up: number): void {
    this.flight = null;
    this.grabbed = this.pick(right, up) ?? this.pointAt(right, up);
  }

  /// A turn begins: close to the surface, around what is in the middle of the picture.
  grabMiddle(): void {
    this.flight = null;
    if (this.pose.distance > this.whole.distance * 0.5) return;
    const point = this.pick(0, 0);
    if (point !== null && this.isParallel) this.pose = slide(this.pose, depthOf(this.pose, point));
    else if (point !== null) this.pose = retarget(this.pose, Math.max(depthOf(this.pose, point), this.whole.distance * NEAREST));
  }

  move(moves: Partial<Moves>): void {
    this.flight = null;
    this.glide.add(moves);
    this.wake();
  }

  /// True if the pose is another one than in the frame before.
  step(now: number): boolean {
    const passed = Math.min(now - this.before, LONGEST_FRAME);
    this.before = now;
    if (this.flight !== null) this.follow(this.flight, now);
    else if (this.glide.busy) this.apply(this.glide.take(passed, still.matches));
    const moved = this.seen?.equals(this.pose) !== true;
    this.seen = this.pose;
    return moved;
  }

  private get isParallel(): boolean {
    return this.projection === 'parallel';
  }

  private start(flight: Flight, to: CameraPose): void {
    this.stop();
    if (still.matches) this.pose = to;
    else this.flight = flight;
    this.wake();
  }

  private stop(): void {
    this.flight = null;
    this.glide.clear();
  }

  private follow(flight: Flight, now: number): void {
    const { pose, done } = flight.at(now);
    this.pose = pose;
    if (done) this.flight = null;
  }

  private apply({ turnRight, turnUp, panRight, panUp, zoom: logarithm }: Moves): void {
    const held = this.grabbed ?? this.pose.target;
    if (turnRight !== 0 || turnUp !== 0) this.pose = turn(this.pose, turnRight, turnUp);
    if (panRight !== 0 || panUp !== 0) this.pose = pan(this.pose, panRight, panUp, this.depthFor(held));
    if (logarithm !== 0) this.pose = zoom(this.pose, held, this.allowed(Math.exp(logarithm)));
  }

  private depthFor(point: Vector3): number {
    if (this.isParallel) return this.pose.distance;
    const depth = depthOf(this.pose, point);
    return depth > 0 ? depth : this.pose.distance;
  }

  private allowed(factor: number): number {
    const { distance } = this.pose;
    const [least, most] = [this.whole.distance * NEAREST, this.whole.distance * FARTHEST];
    return Math.min(Math.max(distance * factor, Math.min(least, distance)), Math.max(most, distance)) / distance;
  }

  /// As far away as the target.
  private pointAt(right: number, up: number): Vector3 {
    return pan(this.pose, (right * this.aspect) / 2, up / 2, this.pose.distance).target;
  }
}
