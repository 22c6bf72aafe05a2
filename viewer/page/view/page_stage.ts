// SPDX-License-Identifier: MIT
// A model's view for plug-ins and tools.
import type { HierarchyView, Stage } from '../../src/index.js';
import type { CameraPose } from '../../src/scene/camera_pose.js';
import type { Projection } from '../../src/scene/projection.js';
import type { DrawPart, PictureSize } from '../../src/tools/screenshot.js';
import { fileOf } from '../listing.js';
import type { Telling } from '../problems.js';
import type { Canvas } from './canvas.js';
import type { PointFinder } from '../../src/tools/point_finder.js';
import type { PageFrames } from './page_frames.js';
import { isStanding, type Sight, type ViewCamera } from './view_camera.js';
import { fittedLink } from '../../src/view/view_link.js';
import type { ViewChoices } from './view_choices.js';
import type { PageContext } from './page_context.js';

/// Two models in the picture, as stories tell of them; `text`: as links have it.
interface ToldPair {
  readonly text: string;
  tell(choices: string): void;
}

/// The tools; `toldText`: as links have what they show, but for notes, which tell the story.
interface ToldTools {
  readonly toldText: string;
  tell(choices: string): void;
}

export class PageStage implements Stage {
  readonly view: HierarchyView;
  readonly renderer: Canvas['renderer'];
  readonly scene: Canvas['scene'];
  readonly camera: Canvas['camera'];
  /// Holds everything around the picture.
  readonly root: HTMLElement;
  readonly surface: HTMLElement;
  readonly signal: AbortSignal;
  readonly name: string;
  /// The file of the hierarchy: its story lies beside it under that name and ".story.json".
  readonly fileName: string;
  /// They come after the stage, which they stand on.
  tools: ToldTools | null = null;
  pair: ToldPair | null = null;

  constructor(readonly context: PageContext, private readonly moves: ViewCamera, private readonly looks: ViewChoices, private readonly frames: PageFrames) {
    const { view, canvas, root, surface, signal, model } = context;
    [this.view, this.root, this.surface, this.signal] = [view, root, surface, signal];
    [this.renderer, this.scene, this.camera] = [canvas.renderer, canvas.scene, canvas.camera];
    [this.name, this.fileName] = [model.name, fileOf(model)];
    view.plugins.enter(this);
  }

  pose(): CameraPose {
    return this.moves.navigation.pose;
  }

  get projection(): Projection {
    return this.moves.projection;
  }

  set projection(projection: Projection) {
    this.moves.projection = projection;
  }

  /// Tells the projection now and whenever it is another one.
  onProjection(tell: (projection: Projection) => void): void {
    this.context.addEventListener('chosen', () => { tell(this.projection); });
    tell(this.projection);
  }

  jump(pose: CameraPose): void {
    if (isStanding(pose)) this.moves.navigation.jump(pose);
  }

  fly(pose: CameraPose): void {
    if (isStanding(pose)) this.moves.navigation.fly(pose);
  }

  travel(pose: CameraPose): number {
    return isStanding(pose) ? this.moves.navigation.travel(pose) : 0;
  }

  redraw(): void {
    this.context.redraw();
  }

  get points(): PointFinder | null {
    return this.context.canvas.partner?.points ?? null;
  }

  inColumn(right: number, up: number): readonly [number, number] {
    return this.context.canvas.inColumn(right, up);
  }

  suspend(): () => void {
    return this.frames.pause();
  }

  /// All of the view but the camera, the look in from outside, and notes.
  present(choices: string): void {
    this.moves.tell(choices);
    this.looks.tell(choices);
    this.tools?.tell(choices);
    this.pair?.tell(choices);
  }

  /// The same, as links have it.
  choices(): string {
    return fittedLink([this.moves.text, this.looks.text, this.pair?.text ?? '', this.tools?.toldText ?? ''].filter((text) => text !== '').join('&')).link;
  }

  /// From now on the camera stands, the view refines for a picture of that size, and the page shows what it shows, until it is released.
  /// `sight`: the picture's own.
  freeze(size: PictureSize, sight?: Sight): { readonly draw: DrawPart; release(): void } {
    return this.moves.freeze(size, sight);
  }

  /// A frame was drawn since whatever was last changed, and nothing is left to refine.
  get isSettled(): boolean {
    return this.frames.isSettled;
  }

  /// Tells a message, which the function that it returns takes away.
  tell(message: string, telling?: Pick<Telling, 'more' | 'retry'>): () => void {
    return this.context.page.problems.tell(message, { ...telling, subject: 'tools' });
  }
}
