// SPDX-License-Identifier: MIT
// What the format allows of a tile (docs/file_format.md): sizes are computed from counts within these.

/// Vertices of its own.
export const MOST_OWN = 32768;
/// Ghosts, triangles, and whatever else is counted.
export const MOST_ELEMENTS = 2 ** 26;
/// Of a root, which nothing else tells of: more than its largest file has room for without compression.
export const MOST_ROOT_TRIANGLES = 2 ** 22;

/// Of a picture, texels.
export const MOST_SIDE = 8192;

/// Each is at a triangle's corner.
export function mostSplits({ interior, border }: { interior: number; border: number }): number {
  return 3 * (interior + border);
}
