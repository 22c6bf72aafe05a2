// What the tools need of the view, and the view of the tools.
import type { PerspectiveCamera } from 'three';
import type { HierarchyView } from '../../src/index.js';
import type { CameraPose } from '../view/camera_pose.js';
import type { Painter } from '../view/stage.js';

export type ToolName = 'pick' | 'measure' | 'clip';

export interface Bench {
  readonly name: string;
  readonly view: HierarchyView;
  readonly camera: PerspectiveCamera;
  /// Holds everything around the picture.
  readonly root: HTMLElement;
  /// What the picture is drawn on, and has the focus.
  readonly surface: HTMLElement;
  /// Aborts with the view.
  readonly signal: AbortSignal;
  pose(): CameraPose;
  redraw(): void;
  /// Draws instead of the view, until null is given.
  setPainter(painter: Painter | null): void;
  /// What it returns takes the message away.
  tell(message: string): () => void;
}

/// Places of the picture are from -1 to 1 to the right and up.
export interface Tools {
  /// Null: the bar alone, or nothing any more if it is there.
  toggle(name: ToolName | null): void;
  /// False: no tool has use for it.
  tapped(right: number, up: number): boolean;
  /// After each frame.
  drawn(): void;
  /// Puts away the tool, then the bar. False: nothing is there.
  back(): boolean;
}
