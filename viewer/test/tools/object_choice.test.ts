// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { ALL_OBJECTS, alone, visibilityOf, withShown, type ObjectChoice, type Visibility } from '../../src/tools/object_choice.js';

const HOUSE: ObjectChoice = { hidden: ['a/', 'b/room/wall'], only: [], shown: ['a/room/'] };

describe('what is drawn of a tree of names', () => {
  it.each<[string, Visibility]>([
    ['a/', 'mixed'], ['a/hall/', 'hidden'], ['a/room/', 'shown'], ['a/room/wall', 'shown'], ['a', 'shown'], ['b/', 'mixed'], ['b/room/', 'mixed'], ['b/room/wall', 'hidden'],
    ['b/room/wall/', 'shown'], ['c', 'shown'], ['', 'shown'],
  ])('"%s" is %s', (text, is) => { expect(visibilityOf(HOUSE, text)).toBe(is); });

  it.each<[string, Visibility]>([['a/', 'mixed'], ['a/room/', 'mixed'], ['a/room/wall', 'hidden'], ['a/hall/', 'hidden'], ['b', 'hidden']])('where one branch is alone, "%s" is %s', (text, is) => {
    expect(visibilityOf({ hidden: ['a/room/wall'], only: ['a/room/'], shown: [] }, text)).toBe(is);
  });

  it('is hidden and shown in a branch of a branch, in as few texts as will do', () => {
    let choice = withShown(ALL_OBJECTS, 'a/', false);
    choice = withShown(choice, 'a/room/', true);
    choice = withShown(choice, 'a/room/wall', false);
    expect(choice).toEqual({ hidden: ['a/', 'a/room/wall'], only: [], shown: ['a/room/'] });
    expect(withShown(choice, 'a/room/wall', true)).toEqual({ hidden: ['a/'], only: [], shown: ['a/room/'] });
    expect(withShown(choice, 'a/', true)).toEqual(ALL_OBJECTS);
    expect(withShown(choice, 'a/', false)).toEqual({ ...ALL_OBJECTS, hidden: ['a/'] });
  });

  it('is what was drawn of it before, once it is alone', () => {
    expect(alone({ hidden: ['a/', 'a/room/wall', 'b'], only: ['c'], shown: ['a/room/'] }, 'a/room/')).toEqual({ hidden: ['a/room/wall'], only: ['a/room/'], shown: [] });
  });
});
