// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { INNER_KEYS, TOOL_KEYS } from '../../page/tools/keys.js';
import { needsKey, VIEW_KEYS } from '../../page/view/keys.js';

describe('keys that an input needs', () => {
  it.each([
    ['checkbox', ' ', true], ['checkbox', 'ArrowUp', false], ['checkbox', 'w', false],
    ['radio', 'ArrowUp', true], ['radio', 'w', false], ['radio', '3', false],
    ['range', 'Home', true], ['range', 'PageDown', true], ['range', '+', false],
    ['number', '3', true], ['text', 'Backspace', true],
  ])('%s, "%s": %s', (type, key, needed) => { expect(needsKey(type, key)).toBe(needed); });
});

describe('the keys', () => {
  it('mean one thing each', () => {
    const all = [...VIEW_KEYS, ...[...Object.values(TOOL_KEYS), ...Object.values(INNER_KEYS)].map((key) => key.toLowerCase())];
    expect(all.filter((key, i) => all.indexOf(key) !== i)).toEqual([]);
  });
});
