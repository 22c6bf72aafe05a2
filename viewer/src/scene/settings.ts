// SPDX-License-Identifier: MIT
// The settings and looks that a user of the library may choose, and the figures that a view tells.
import type { ScalarAttribute } from '../hierarchy/scalar_values.js';
import type { RampName } from './ramp_names.js';

/// Tiles' colours: one for all; those of the input; by one of its attributes; one for each tile; by the error on screen; by height.
export type Colours = 'plain' | 'vertex' | 'attribute' | 'partition' | 'error' | 'height';

/// How an attribute is shown.
export interface AttributeLook {
  /// Its name; one that the model does not have is its first one.
  attribute: string;
  ramp: RampName;
  /// Values at the ends of the ramp; null: the least and the most, of signed values as far on both sides of 0.
  range: readonly [number, number] | null;
  /// Values no farther from 0 have one colour, and the ramp begins beyond them; null: 0 is a value like others.
  tolerance: number | null;
  /// Lines of equal value, about ten.
  isolines: boolean;
  /// Labels that are not drawn.
  hidden: readonly number[];
}

export interface Look extends AttributeLook {
  /// `attribute`: of a mesh without any it is `plain`. `vertex`: the input's pictures, else its vertices' colours; where the mesh has neither it is `plain`.
  colours: Colours;
  /// Pictures are shown.
  texture: boolean;
  /// Pictures that have their light already are lit all the same.
  relight: boolean;
  /// `matcap`: like a ball of clay in a bright room, whatever lights there are. `relief`: what bends within pixels stands out, as scratches and letters do.
  material: 'lit' | 'matcap' | 'relief';
  /// So many times steeper slopes are shaded than they are, 1 … 1000; each triangle's own normal stays.
  relief: number;
  /// Hollows are darker, edges lighter.
  cavities: boolean;
  /// `flat`: each triangle has its own normal.
  shading: 'smooth' | 'flat';
  wires: boolean;
  points: boolean;
  /// The shape-outline over the mesh; fetched when first asked for.
  outline: boolean;
}

export interface Settings {
  /// Frames per second to hold while the camera moves, 1 … 240.
  framesPerSecond: number;
  /// Largest error on screen, in pixels (of the viewport given to `update`).
  threshold: number;
  /// A view at rest divides the threshold by it once all is there, step by step, as long as triangles are larger than a pixel: 1 … 16.
  restDetail: number;
  /// Bytes of all tiles in memory, those in GPU buffers included: never exceeded, but that the root stays.
  memoryBudget: number;
}

/// A view looks so if nothing is said.
export const DEFAULT_LOOK: Look = {
  colours: 'vertex', texture: true, relight: false, material: 'lit', relief: 1, cavities: true, shading: 'smooth', wires: false, points: false, outline: false,
  attribute: '', ramp: 'viridis', range: null, tolerance: null, isolines: false, hidden: [],
};

/// Returns the values at the ends of the ramp if a look does not say them.
export function wholeRange({ min, max }: ScalarAttribute, ramp: RampName): readonly [number, number] {
  const most = Math.max(-min, max);
  return ramp === 'coolwarm' && min < 0 && max > 0 ? [-most, most] : [min, max];
}

/// Returns the place of the attribute of that name, else of the first one; -1: there is none.
export function attributeIndex(attributes: readonly ScalarAttribute[], name: string): number {
  return Math.max(attributes.findIndex((each) => each.name === name), Math.min(0, attributes.length - 1));
}

const DEFAULTS: Settings = { framesPerSecond: 30, threshold: 1, restDetail: 8, memoryBudget: 256e6 };
const RANGES: Record<keyof Settings, readonly [number, number]> = {
  framesPerSecond: [1, 240],
  threshold: [0.01, 1000],
  restDetail: [1, 16],
  memoryBudget: [1e6, 2 ** 40],
};

/// `current` with a change; what is undefined in it stays. Throws RangeError for what is out of its range.
export function changedSettings(change: Partial<Settings>, current = DEFAULTS): Settings {
  const settings = { ...current };
  for (const key of Object.keys(RANGES) as (keyof Settings)[]) {
    const value = change[key] ?? current[key];
    const [least, most] = RANGES[key];
    if (!(value >= least && value <= most)) throw new RangeError(`${key} is ${value}, not from ${least} to ${most}`);
    settings[key] = value;
  }
  return settings;
}

/// Kim & Lee's names: coarse whole view (all of the model is in view), zoomed sector view, deep zoom
/// of the mesh (what fills the picture are original triangles).
export type Mode = 'CWV' | 'ZSV' | 'DZM';

export interface Stats {
  mode: Mode;
  /// Frames per second while the camera moves; of the last movement when it stands still.
  framesPerSecond: number;
  moving: boolean;
  /// The view stands still, and nothing is left to fetch or refine.
  settled: boolean;
  /// Tiles of the cut that are in the frustum, and what they hold.
  tiles: number;
  triangles: number;
  vertices: number;
  finestLevel: number;
  coarsestLevel: number;
  /// The most vertices that the rate asked for allows.
  vertexBudget: number;
  /// More would be shown if more of these were allowed: vertices while the camera moves, bytes of tiles.
  limited: { vertices: boolean; bytes: boolean };
  /// Bytes of all tiles that the view asks for, as far as they are allowed, with room for one on its way.
  wantedBytes: number;
  /// Largest error of what is shown, in pixels; Infinity while it is not known.
  worstError: number;
  residentTiles: number;
  residentBytes: number;
  /// The most that residentBytes ever was.
  peakBytes: number;
  memoryBudget: number;
  /// The bytes of files with tiles, as stored.
  fetchedBytes: number;
  fetchedFiles: number;
  /// Bytes that sending each settled view whole would have taken, and those of them that were not sent.
  wholeViewBytes: number;
  savedBytes: number;
  /// Tiles of settled views that were there already.
  hits: number;
  pending: number;
  aborted: number;
  failed: number;
  evicted: number;
  decodeMilliseconds: number;
}
