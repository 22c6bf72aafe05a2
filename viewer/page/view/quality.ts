// SPDX-License-Identifier: MIT
// Qualities by name: what most people choose instead of numbers.
import type { Settings } from '../../src/scene/settings.js';
import { MEGABYTE } from '../preferences.js';

export const QUALITIES = ['fast', 'balanced', 'fine'] as const;
export type Quality = (typeof QUALITIES)[number];

type QualityNumbers = Pick<Settings, 'framesPerSecond' | 'threshold' | 'memoryBudget'>;

/// `balanced`: the defaults.
export const PRESETS: Readonly<Record<Quality, QualityNumbers>> = {
  fast: { framesPerSecond: 60, threshold: 3, memoryBudget: 128 * MEGABYTE },
  balanced: { framesPerSecond: 30, threshold: 1, memoryBudget: 256 * MEGABYTE },
  fine: { framesPerSecond: 20, threshold: 0.5, memoryBudget: 1024 * MEGABYTE },
};

/// Null: numbers of the user's own.
export function qualityOf(settings: QualityNumbers): Quality | null {
  const keys = Object.keys(PRESETS.balanced) as (keyof QualityNumbers)[];
  return QUALITIES.find((quality) => keys.every((key) => PRESETS[quality][key] === settings[key])) ?? null;
}
