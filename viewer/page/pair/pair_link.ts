// SPDX-License-Identifier: MIT
// What links say of two models in one picture. Which model is the other one stands in the query (query.ts).
import type { Way } from '../../src/pair/ways.js';
import { readLink, writeLink } from '../../src/view/view_link.js';
import { valueOf } from '../../src/view/view_table.js';

export interface PairLook {
  readonly way: Way;
  /// The part of the picture's width that the first model has in a swipe, 0 … 1.
  readonly divider: number;
}

const DIGITS = 4;

/// What cannot be read is as if it were not there.
export function readPairLook(choices: string): PairLook {
  const view = readLink(choices);
  return { way: valueOf(view, 'way')!, divider: valueOf(view, 'divider')! };
}

export const DEFAULT_PAIR = readPairLook('');

/// Choices with & between; empty: all is as without one.
export function formatPairLook({ way, divider }: PairLook): string {
  return writeLink({ way, divider: Number(divider.toPrecision(DIGITS)) });
}
