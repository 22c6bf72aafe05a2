// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { DEFAULT_APPEARANCE, withChoices, type Appearance } from '../../page/appearance.js';
import { Told } from '../../page/story/told.js';
import { DEFAULT_LOOK } from '../../src/scene/settings.js';

const BEFORE: Appearance = { ...DEFAULT_APPEARANCE, look: { ...DEFAULT_LOOK, wires: true } };

describe('what a story shows', () => {
  it('goes with it', () => {
    const told = new Told(withChoices);
    const first = told.tell('light=raking', BEFORE);
    expect([first.light.name, first.look.wires]).toEqual(['raking', false]);
    const second = told.tell('', first);
    expect(second).toEqual(BEFORE); // a note without a look of its own: not that of the note before
    expect(told.end(second)).toBe(BEFORE);
  });

  it('stays where the visitor has chosen something else since', () => {
    const told = new Told(withChoices);
    const first = told.tell('colours=partition', BEFORE);
    const own = { ...first, look: { ...first.look, points: true } };
    expect(told.end(own)).toBe(own);
    told.tell('colours=partition', BEFORE);
    const next = told.tell('light=flat', own);
    expect(told.end(next)).toBe(own);
  });
});
