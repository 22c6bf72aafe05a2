// SPDX-License-Identifier: MIT
/// How two models in one picture are looked at.
export const WAYS = ['swipe', 'side', 'blink', 'overlay'] as const;
export type Way = (typeof WAYS)[number];
