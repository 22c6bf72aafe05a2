// SPDX-License-Identifier: MIT
/// Ramps of colours (ramps.ts).
export const RAMPS = ['viridis', 'cividis', 'turbo', 'coolwarm'] as const;
export type RampName = (typeof RAMPS)[number];
