// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { changedSettings } from '../../src/scene/settings.js';
import { MEGABYTE, parsePreferences, RANGES } from '../../page/preferences.js';
import { PRESETS, QUALITIES, qualityOf } from '../../page/view/quality.js';

describe('a quality', () => {
  it.each(QUALITIES)('%s is within what may be chosen, and kept', (quality) => {
    const { framesPerSecond, threshold, memoryBudget } = PRESETS[quality];
    for (const [value, { least, most }] of [[framesPerSecond, RANGES.framesPerSecond], [threshold, RANGES.threshold], [memoryBudget / MEGABYTE, RANGES.memoryBudget]] as const) {
      expect(value).toBeGreaterThanOrEqual(least);
      expect(value).toBeLessThanOrEqual(most);
    }
    expect(qualityOf(parsePreferences(JSON.stringify({ settings: PRESETS[quality] })).settings)).toBe(quality);
  });

  it('is balanced by default, and none with other numbers', () => {
    expect(qualityOf(changedSettings({}))).toBe('balanced');
    expect(qualityOf({ ...PRESETS.fine, threshold: 2 })).toBeNull();
  });
});
