// SPDX-License-Identifier: MIT
export { Pair, TINTS, type PairOptions, type PairStats, type SeenPlace, type Side } from './pair.js';
export { WAYS, type Way } from './ways.js';
export { PairPoints, type Across, type PairedPoint } from './pair_points.js';
export type { Laying } from './placing.js';
