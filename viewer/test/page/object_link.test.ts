// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { formatObjectLink, objectsOfChoices, parseObjectLink, type ObjectLink } from '../../page/tools/object_link.js';
import { ObjectLinkStore } from '../../page/tools/object_link_store.js';

const NOTHING: ObjectLink = { picked: null, by: null, between: null, hidden: [], only: [], shown: [] };

describe('a link to objects', () => {
  it.each<ObjectLink>([
    NOTHING, { ...NOTHING, picked: 'street 01/house 02' }, { ...NOTHING, picked: '' }, { picked: 'a+b & c=d, é #%41', by: 'is & was', between: [-1e-9, 1 / 3], hidden: ['x,y', 'storey/', ''], only: ['\u{1f3e0}/'], shown: ['storey/a', '<b>/'] },
  ])('tells what it was made of: %j', (link) => { expect(parseObjectLink(formatObjectLink(link))).toEqual(link); });

  it('is nothing where nothing is chosen', () => { expect(formatObjectLink(NOTHING)).toBeNull(); });

  it('leaves out what makes it too long', () => {
    const hidden = Array.from({ length: 500 }, (_, i) => `house ${i}`);
    const text = formatObjectLink({ ...NOTHING, picked: 'a', hidden })!;
    expect(text.length).toBeLessThan(2000);
    expect(parseObjectLink(text).hidden.length).toBeGreaterThan(80);
    expect(formatObjectLink({ ...NOTHING, picked: 'x'.repeat(5000) })).toBeNull();
  });

  it.each(['1', '1,2,3', ',', 'a,b', '1,Infinity', ''])('has no range of "%s"', (text) => { expect(parseObjectLink(`by=a&between=${text}`).between).toBeNull(); });

  it('is found among the choices of others', () => {
    expect(objectsOfChoices('wires=on&object=a%26b&notes=xyz&hide=c&only=d&hider=1')).toBe('object=a%26b&hide=c&only=d');
    expect(objectsOfChoices('wires=on&objects=3')).toBeNull();
    expect(objectsOfChoices('')).toBeNull();
  });
});

describe('what the address tells of objects', () => {
  it('is told once to those who follow, and put there once', () => {
    const put: (string | null)[] = [];
    const store = new ObjectLinkStore('object=a', (link) => { put.push(link); });
    let followed = 0;
    store.onFollow(() => { ++followed; });
    store.follow('object=a');
    store.write('object=a');
    expect([followed, put.length]).toEqual([0, 0]);
    store.write(null);
    store.follow('object=b');
    store.follow('object=b');
    expect([followed, put, store.text]).toEqual([1, [null], 'object=b']);
  });
});
