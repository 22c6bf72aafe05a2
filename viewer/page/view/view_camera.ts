// SPDX-License-Identifier: MIT
// The camera of a model's view: where it stands, what of the model is in the picture, and when it rests.
import { Box3, Vector3 } from 'three';
import { CameraPose, type Pose } from '../../src/scene/camera_pose.js';
import type { Projection } from '../../src/scene/projection.js';
import type { Standing } from '../../src/scene/standing.js';
import type { DrawPart, PictureSize } from '../../src/tools/screenshot.js';
import { readLink, writeLink } from '../../src/view/view_link.js';
import { problemOfPose, roundedPose } from '../address.js';
import { towardsViewer } from '../gallery/layout.js';
import { wholeView } from './camera_moves.js';
import type { Moves } from './glide.js';
import { firstPose } from './first_view.js';
import { Lens } from './lens.js';
import { Navigation } from './navigation.js';
import type { PageContext } from './page_context.js';

const UNKNOWN = new Box3(new Vector3(-1, -1, -1), new Vector3(1, 1, 1));

/// True where a camera can stand so.
export function isStanding(pose: CameraPose): boolean {
  const { position, target } = pose.toPose();
  return problemOfPose(position, target) === null;
}

/// How a camera sees the model.
export interface Sight {
  readonly pose: CameraPose;
  readonly projection: Projection;
}

export class ViewCamera {
  readonly navigation: Navigation;
  private seesBy: Projection = 'perspective';
  /// While a picture is taken.
  private frozen: Sight | null = null;
  private readonly framed = new Box3();
  private standing: Readonly<Standing> | null = null;
  private readonly lens = new Lens();
  /// From before a story was told; null: none is.
  private untold: Projection | null = null;
  /// From where the whole is seen until it is there and the camera flies to its first view.
  private approach: ReturnType<typeof towardsViewer> | null = null;

  constructor(private readonly context: PageContext) {
    const { canvas, arrival: { turn } } = context;
    this.navigation = new Navigation((right, up) => canvas.pick(right, up), () => { context.redraw(); });
    if (turn !== null && context.view.standing.up === 'file') this.approach = towardsViewer(turn);
    context.addEventListener('opened', () => {
      if (context.arrival.poster?.isMoving !== true || this.projection === 'parallel' || this.firstPose() !== null) this.lens.end();
      this.reframe();
    });
    context.addEventListener('manifest', () => { this.reframe(); });
    context.addEventListener('story', ({ isTold }) => {
      if (isTold || this.untold === null) return;
      this.projection = this.untold;
      this.untold = null;
    });
  }

  /// As links have it.
  pose(): Pose {
    return roundedPose(this.navigation.pose.toPose());
  }

  /// Null: as the model is seen first.
  setPose(pose: Pose | null): void {
    if (pose === null) this.navigation.goHome();
    else this.navigation.jump(CameraPose.from(pose));
  }

  get projection(): Projection {
    return this.seesBy;
  }

  /// What lies at the camera's target stays as large.
  set projection(projection: Projection) {
    if (projection === this.seesBy) return;
    this.seesBy = projection;
    if (this.context.isOpened) this.reframe();
    this.context.redraw();
    this.context.startRest();
    this.context.dispatchEvent({ type: 'chosen' });
  }

  toggleProjection(): void {
    this.projection = this.projection === 'parallel' ? 'perspective' : 'parallel';
  }

  /// As links have it, but for the pose.
  get text(): string {
    return writeLink({ projection: this.projection });
  }

  /// As a link says.
  follow(choices: string): void {
    this.projection = readLink(choices).projection ?? 'perspective';
  }

  /// As a note of a story wants it.
  tell(choices: string): void {
    this.untold ??= this.projection;
    this.follow(choices);
  }

  /// It will stand elsewhere in the next frame.
  get busy(): boolean {
    return this.navigation.busy || (this.context.isShown && !this.lens.isUsual);
  }

  /// A picture is being taken: the page's waits.
  get isFrozen(): boolean {
    return this.frozen !== null;
  }

  /// Takes the steps that are due. True: it stands elsewhere than in the frame before.
  step(now: number): boolean {
    const { isShown, view } = this.context;
    if (this.approach !== null && isShown && view.manifest !== null) this.arrive();
    const moved = this.frozen === null && this.navigation.step(now);
    if (moved) this.context.startRest();
    if (!this.navigation.atHome) this.lens.end();
    return this.lens.step(now, isShown) || moved;
  }

  /// The manifest knows the box better than the root.
  aim(isResized: boolean): void {
    const { isOpened, view, canvas, canvas: { box } } = this.context;
    if (isOpened && (isResized || !this.framed.equals(box) || this.standing !== view.standing)) this.reframe();
    if (this.lens.isUsual || this.frozen !== null || !isOpened) {
      const { pose, projection } = this.frozen ?? this.sight;
      canvas.aim(pose, isOpened ? box : UNKNOWN, { projection });
    } else canvas.aim(this.whole(this.lens.angle), box, { angle: this.lens.angle });
  }

  /// `sight`: of the picture, whatever the page goes on showing.
  freeze(size: PictureSize, sight: Sight = this.sight): { readonly draw: DrawPart; release(): void } {
    const { canvas } = this.context;
    const hold = (asked: PictureSize | null): void => {
      this.frozen = asked && sight;
      canvas.asked = asked;
      this.aim(false); // parts may be drawn before the next frame
      this.context.redraw();
    };
    hold(size);
    return { draw: canvas.drawPart, release: () => { hold(null); } };
  }

  /// `logarithm`: of a factor.
  zoomMiddle(logarithm: number): void {
    this.navigation.grab(0, 0);
    this.navigation.move({ zoom: logarithm });
  }

  moveByKey(moves: Partial<Moves>): void {
    if (moves.turnRight !== undefined) this.navigation.grabMiddle();
    else this.navigation.grab(0, 0);
    this.navigation.move(moves);
  }

  private get sight(): Sight {
    return { pose: CameraPose.from(this.pose()), projection: this.projection };
  }

  /// All of the model in the picture.
  private whole(angle: number): CameraPose {
    const { view, canvas } = this.context;
    return wholeView(this.framed, canvas.aspect, view.firstDirection, view.shape(), 'perspective', angle);
  }

  /// As the manifest says; null: all of the model.
  private firstPose(): CameraPose | null {
    const { view: { manifest, standing } } = this.context;
    const pose = this.approach === null ? firstPose(manifest, standing) : null;
    return pose && CameraPose.from(pose);
  }

  private reframe(): void {
    const { view, canvas } = this.context;
    this.framed.copy(canvas.box);
    this.standing = view.standing;
    this.navigation.frame(this.framed, {
      aspect: canvas.aspect, projection: this.projection, direction: this.approach ?? view.firstDirection, points: canvas.shape(), first: this.firstPose(),
    });
  }

  private arrive(): void {
    const { pose, atHome } = this.navigation;
    this.approach = null;
    this.reframe();
    if (!atHome) return; // it has been moved meanwhile
    this.navigation.jump(pose);
    this.navigation.goHome();
  }
}
