// SPDX-License-Identifier: MIT
// The format allows a tile no more (docs/file_format.md): sizes are computed from counts within these limits.

/// Vertices of its own.
export const MOST_OWN = 32768;
/// Ghosts, triangles, and whatever else is counted.
export const MOST_ELEMENTS = 2 ** 26;
/// Nothing else tells of a root: its largest file has room for fewer without compression.
export const MOST_ROOT_TRIANGLES = 2 ** 22;

/// The longest side of a picture, in texels.
export const MOST_SIDE = 8192;

/// Each is at a triangle's corner.
export function mostSplits({ interior, border }: { interior: number; border: number }): number {
  return 3 * (interior + border);
}
