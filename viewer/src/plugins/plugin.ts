// SPDX-License-Identifier: MIT
// Plug-ins: what a view can do besides showing tiles, in modules that are loaded where they are wanted.
import type { Plane, Scene, Vector3, WebGLRenderer } from 'three';
import type { CameraPose } from '../scene/camera_pose.js';
import type { ViewCamera } from '../scene/projection.js';
import type { Shading } from '../scene/shading.js';
import type { PointFinder } from '../tools/point_finder.js';
import { attempt } from './attempt.js';

/// A frame is drawn by the renderer, of the scene, as the camera sees it.
export interface Frame {
  readonly renderer: WebGLRenderer;
  readonly scene: Scene;
  readonly camera: ViewCamera;
}

/// A stage shows a view, with a camera that can be moved: the page is one, and so is `<meshhier-viewer>`.
export interface StageOf<View> extends Frame {
  readonly view: View;
  /// Holds the surface; what is added to it lies over the picture.
  readonly root: ParentNode;
  /// The picture is drawn on it, and it has the focus.
  readonly surface: HTMLElement;
  /// Aborts when the view is closed.
  readonly signal: AbortSignal;
  /// Returns where the camera stands and what it looks at.
  pose(): CameraPose;
  /// Moves the camera at once. Nothing happens where no camera can stand so, here and in the next two.
  jump(pose: CameraPose): void;
  /// Moves the camera on a way that is seen, where the stage has one.
  fly(pose: CameraPose): void;
  /// Moves the camera as stories go from place to place. Returns the milliseconds that it takes.
  travel(pose: CameraPose): number;
  /// Asks for a frame, as after a change that the view cannot see.
  redraw(): void;
  /// Frames are drawn by somebody else, until the function that it returns is called.
  suspend(): () => void;
  /// Shows the model so from now on, as links say it. A stage without links lacks it.
  present?(choices: string): void;
  /// The place of a column of the picture that a place of the picture lies in; missing: there is one column.
  inColumn?(right: number, up: number): readonly [number, number];
  /// Finds points where more than the view is in the picture; missing: on the view.
  readonly points?: PointFinder | null;
}

/// A plug-in may lack everything but the name. Places of the picture are from -1 to 1, to the right and up. It may register and take away others
/// in `init` and `enter`. One that throws in `init` or `enter` is taken away; a later member that throws is told as an error that nobody has
/// caught, and not asked again until the plug-in is registered anew.
export interface PluginOf<View> {
  /// No two plug-ins of a view have the same.
  readonly name: string;
  /// Changes how tiles are shaded; the same object as long as the plug-in is registered.
  readonly shading?: Shading;
  /// It belongs to a view from now on, which may know nothing of the model yet. Called once each time that it is registered.
  init?(view: View): void;
  /// The view is on a stage: one in a scene of your own is not. Called after `init`, at once or when the stage is there.
  enter?(stage: StageOf<View>): void;
  /// Draws the scene in its own way, instead of `renderer.render`, and keeps later plug-ins from doing so. False: it does not now.
  paint?(frame: Frame): boolean;
  /// Draws over what `renderer.render` has drawn; not over what a plug-in has painted.
  shade?(frame: Frame): void;
  /// Draws marks over the picture, whoever has drawn or painted it, and after all that plug-ins have drawn over it.
  mark?(frame: Frame): void;
  /// A frame is complete: time for what lies over the canvas.
  drawn?(frame: Frame): void;
  /// Planes of the world: what lies behind one of them is not drawn.
  readonly cuts?: readonly Plane[];
  /// False: where its planes cut a closed model it stays open. Missing: it is closed by caps.
  readonly isCapped?: boolean;
  /// Tells whether a point of the world is drawn: one that any plug-in leaves out is not picked. Called for each hit of a ray. `values`: of a
  /// corner of its triangle, as the manifest lists them.
  keeps?(point: Vector3, values: readonly number[]): boolean;
  /// A place of the picture was tapped. True: it was meant for this plug-in, and no later one is asked.
  tapped?(right: number, up: number): boolean;
  /// It was taken away, or the view was disposed of, or it could not begin. It may be registered again afterwards.
  dispose?(): void;
}

type Question = 'paint' | 'shade' | 'mark' | 'cuts' | 'drawn' | 'keeps' | 'tapped';

/// False: it has thrown.
function isDone(work: () => void): boolean {
  return attempt(() => {
    work();
    return true;
  }, () => false);
}

/// Holds the plug-ins of a view, in the order in which they came.
export class Plugins<View> {
  private readonly all = new Map<string, PluginOf<View>>();
  /// Questions that a plug-in has thrown at are not put to it again.
  private readonly failed = new Map<PluginOf<View>, Set<Question>>();
  private stage: StageOf<View> | null = null;

  /// `changed`: the picture is another one; `shadings`: all there are, if they are others.
  constructor(private readonly view: View, private readonly changed: (shadings: readonly Shading[] | null) => void) {}

  /// Throws Error where there is one of that name, and what the plug-in throws: then it is not there.
  register(plugin: PluginOf<View>): void {
    if (this.all.has(plugin.name)) throw new Error(`there is a plug-in "${plugin.name}" already`);
    this.all.set(plugin.name, plugin);
    try {
      plugin.init?.(this.view);
      if (this.stage !== null) plugin.enter?.(this.stage);
    } catch (error) {
      this.unregister(plugin);
      throw error;
    }
    this.tellChanged(plugin);
  }

  /// Nothing happens where it is not there.
  unregister(plugin: PluginOf<View>): void {
    if (!this.has(plugin)) return;
    this.all.delete(plugin.name);
    this.failed.delete(plugin);
    isDone(() => plugin.dispose?.());
    this.tellChanged(plugin);
  }

  /// Undefined: there is none of that name.
  named(name: string): PluginOf<View> | undefined {
    return this.all.get(name);
  }

  /// A plug-in that throws is taken away. One may add others, or take them away.
  enter(stage: StageOf<View>): void {
    this.stage = stage;
    for (const plugin of this.every) if (this.has(plugin) && !isDone(() => plugin.enter?.(stage))) this.unregister(plugin);
  }

  /// The scene as plug-ins draw it; without one, as the renderer does.
  paint(frame: Frame): void {
    const { renderer, scene, camera } = frame;
    if (!this.every.some((plugin) => this.ask(plugin, 'paint', () => plugin.paint?.(frame) === true, false))) {
      renderer.render(scene, camera);
      for (const plugin of this.every) this.ask(plugin, 'shade', () => plugin.shade?.(frame), undefined);
    }
    for (const plugin of this.every) this.ask(plugin, 'mark', () => plugin.mark?.(frame), undefined);
  }

  /// Those of all plug-ins.
  get cuts(): readonly Plane[] {
    return this.every.flatMap((plugin) => this.ask(plugin, 'cuts', () => plugin.cuts ?? [], []));
  }

  /// No plug-in leaves what it cuts open.
  get isCapped(): boolean {
    return this.every.every(({ isCapped }) => isCapped !== false);
  }

  drawn(frame: Frame): void {
    for (const plugin of this.every) this.ask(plugin, 'drawn', () => plugin.drawn?.(frame), undefined);
  }

  keeps(point: Vector3, values: readonly number[] = []): boolean {
    return this.every.every((plugin) => this.ask(plugin, 'keeps', () => plugin.keeps?.(point, values) ?? true, true));
  }

  tapped(right: number, up: number): boolean {
    return this.every.some((plugin) => this.ask(plugin, 'tapped', () => plugin.tapped?.(right, up) ?? false, false));
  }

  dispose(): void {
    const all = this.every;
    this.all.clear();
    this.stage = null;
    for (const plugin of all) isDone(() => plugin.dispose?.());
  }

  private get every(): readonly PluginOf<View>[] {
    return [...this.all.values()];
  }

  private has(plugin: PluginOf<View>): boolean {
    return this.all.get(plugin.name) === plugin;
  }

  /// `otherwise`: of a plug-in that has thrown at this question, now or before, or that another one took away meanwhile.
  private ask<Answer>(plugin: PluginOf<View>, question: Question, call: () => Answer, otherwise: Answer): Answer {
    const failed = this.failed.get(plugin) ?? new Set();
    if (!this.has(plugin) || failed.has(question)) return otherwise;
    return attempt(call, () => {
      if (this.has(plugin)) this.failed.set(plugin, failed.add(question));
      return otherwise;
    });
  }

  /// `plugin`: has come or gone.
  private tellChanged(plugin: PluginOf<View>): void {
    const shadings = this.every.flatMap(({ shading }) => (shading === undefined ? [] : [shading]));
    this.changed(plugin.shading === undefined ? null : shadings);
  }
}
