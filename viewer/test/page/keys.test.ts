// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { INNER_KEYS } from '../../page/tools/keys.js';
import { KEYS } from '../../page/view/keys.js';
import { isTyped, needsKey } from '../../src/typing.js';

const VIEW_KEYS = KEYS.map(([key]) => key);

describe('keys that an input needs', () => {
  it.each([
    ['checkbox', ' ', true], ['checkbox', 'ArrowUp', false], ['checkbox', 'w', false],
    ['radio', 'ArrowUp', true], ['radio', 'w', false], ['radio', '3', false],
    ['range', 'Home', true], ['range', 'PageDown', true], ['range', '+', false],
    ['number', '3', true], ['text', 'Backspace', true],
  ])('%s, "%s": %s', (type, key, needed) => { expect(needsKey(type, key)).toBe(needed); });
});

describe('what is typed', () => {
  interface Target { localName: string; type?: string; isContentEditable?: boolean }
  const typed = (key: string, target: Target | null, isComposing = false): boolean =>
    isTyped({ key, isComposing, composedPath: () => (target === null ? [] : [target as unknown as EventTarget, {} as EventTarget]) });
  const FIELDS: Target[] = ['text', 'number', 'url', 'search', 'password', 'color', 'date'].map((type) => ({ localName: 'input', type }));
  FIELDS.push({ localName: 'textarea' }, { localName: 'select' }, { localName: 'div', isContentEditable: true });

  it('into any field is none of the view, whatever the key', () => {
    for (const field of FIELDS)
      for (const key of [...VIEW_KEYS, ...Object.values(INNER_KEYS), 'Enter', 'Escape']) expect(typed(key, field), `${key} in ${JSON.stringify(field)}`).toBe(true);
  });

  it('elsewhere is the view\'s', () => {
    for (const target of [null, { localName: 'div' }, { localName: 'button', type: 'button' }, { localName: 'canvas' }, { localName: 'summary' }]) expect(typed('w', target)).toBe(false);
    expect(typed('w', { localName: 'input', type: 'checkbox' })).toBe(false);
    expect(typed('Escape', { localName: 'input', type: 'range' })).toBe(false);
  });

  it('while letters are composed is none of the view', () => { expect(typed('w', { localName: 'div' }, true)).toBe(true); });
});

describe('the keys', () => {
  it('mean one thing each', () => {
    const all = [...VIEW_KEYS, ...Object.values(INNER_KEYS).map((key) => key.toLowerCase())];
    expect(all.filter((key, i) => all.indexOf(key) !== i)).toEqual([]);
  });
});
