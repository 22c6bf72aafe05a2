// SPDX-License-Identifier: MIT
// Rows of a card that tell of a point where two models are in the picture: which it lies on, and where the other one's surface is.
import type { PairedPoint } from '../../src/pair/index.js';
import type { PickedPoint } from '../../src/tools/picked_point.js';
import type { LengthScale } from '../../src/tools/units.js';
import { line, type Figure } from './figures.js';
import { words } from './words/words.js';

function isPaired(picked: PickedPoint): picked is PairedPoint {
  return 'side' in picked;
}

/// A distance below the last place of the point's coordinates is the rounding of floats.
function toldDistance(distance: number, { places }: PickedPoint): number {
  return Math.abs(distance) < 0.5 * 10 ** Math.max(...places) ? 0 : distance;
}

/// `names`: of both models; `tell`: a value of the other model.
export function pairRows(picked: PickedPoint, names: readonly [string, string], scale: LengthScale, tell: (name: string, value: PickedPoint['values'][number]) => Figure): Figure[] {
  if (!isPaired(picked)) return [];
  const { side, across } = picked;
  const other = names[1 - side];
  const on = line(words.pair.on, names[side]);
  if (across === null) return [on];
  const { by, distance, bound, values } = across;
  const name = words.pair[by](other);
  const far = distance === null ? line(name, words.pair.nowhere) : line(name, scale.formatWithin(toldDistance(distance, picked), bound), distance);
  return [on, far, ...values.map((value) => tell(`${value.name} (${other})`, value))];
}
