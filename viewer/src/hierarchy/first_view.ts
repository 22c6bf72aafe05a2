// SPDX-License-Identifier: MIT
// From where a model is looked at first: what the root tile and the outline say in their extras (docs/file_format.md, section 5.2).

/// Degrees: from the model's front to its right, and above its equator.
export interface FirstView {
  readonly azimuth: number;
  readonly elevation: number;
}

const MOST_AZIMUTH = 360;
const MOST_ELEVATION = 90;
/// Straight from above nobody knows which way is up.
const STEEPEST = 89.5;
const RADIANS = Math.PI / 180;

function isWithin(value: unknown, most: number): value is number {
  return typeof value === 'number' && Math.abs(value) <= most;
}

/// Reads the first view of a glTF document; null: an older program made it. `refuse` is called where what is there is none.
export function readFirstView({ extras }: { extras?: unknown }, refuse: () => never): FirstView | null {
  if (extras === undefined) return null;
  const view: unknown = typeof extras === 'object' && extras !== null ? (extras as { firstView?: unknown }).firstView : null;
  if (!Array.isArray(view) || view.length !== 2) refuse();
  const [azimuth, elevation] = view as unknown[];
  return isWithin(azimuth, MOST_AZIMUTH) && isWithin(elevation, MOST_ELEVATION) ? { azimuth, elevation } : refuse();
}

/// To the viewer, of length 1, in upright coordinates: y up, the front towards z.
export function directionOf({ azimuth, elevation }: FirstView): [number, number, number] {
  const around = azimuth * RADIANS;
  const above = Math.min(Math.max(elevation, -STEEPEST), STEEPEST) * RADIANS;
  return [Math.sin(around) * Math.cos(above), Math.sin(above), Math.cos(around) * Math.cos(above)];
}
