import { describe, expect, it } from 'vitest';
import { needsKey } from '../../page/view/keys.js';

describe('keys that an input needs', () => {
  it.each([
    ['checkbox', ' ', true], ['checkbox', 'ArrowUp', false], ['checkbox', 'w', false],
    ['radio', 'ArrowUp', true], ['radio', 'w', false], ['radio', '3', false],
    ['range', 'Home', true], ['range', 'PageDown', true], ['range', '+', false],
    ['number', '3', true], ['text', 'Backspace', true],
  ])('%s, "%s": %s', (type, key, needed) => { expect(needsKey(type, key)).toBe(needed); });
});
