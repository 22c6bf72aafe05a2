// SPDX-License-Identifier: MIT
// How far away a place may be that somebody else names: in links, stories and attributes.

/// Along an axis. Places stay below the largest number of single precision (3e38), and products of five of them below the largest of
/// double precision (1.8e308).
export const FARTHEST = 1e30;

/// Tells whether all of them are numbers, and no farther.
export function areNear(values: readonly unknown[]): values is readonly number[] {
  return values.every((value) => typeof value === 'number' && Math.abs(value) <= FARTHEST);
}
