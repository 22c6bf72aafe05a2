// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { formatObjectLink, parseObjectLink, type ObjectLink } from '../../page/tools/object_link.js';
import { ToolLink } from '../../page/tools/tool_link.js';
import { fittedLink, linkOf } from '../../src/view/view_link.js';

const NOTHING: ObjectLink = { picked: null, by: null, between: null, hidden: [], only: [], shown: [] };

describe('a link to objects', () => {
  it.each<ObjectLink>([
    NOTHING, { ...NOTHING, picked: 'street 01/house 02' }, { ...NOTHING, picked: '' }, { picked: 'a+b & c=d, é #%41', by: 'is & was', between: [-1e-9, 0.333333333333], hidden: ['x,y', 'storey/', ''], only: ['\u{1f3e0}/'], shown: ['storey/a', '<b>/'] },
  ])('tells what it was made of: %j', (link) => { expect(parseObjectLink(formatObjectLink(link))).toEqual(link); });

  it('is nothing where nothing is chosen', () => { expect(formatObjectLink(NOTHING)).toBe(''); });

  it('leaves out what makes it too long', () => {
    const hidden = Array.from({ length: 500 }, (_, i) => `house ${i}`);
    const { link: text, leftOut } = fittedLink(formatObjectLink({ ...NOTHING, picked: 'a', hidden }));
    expect([text.length < 2000, leftOut]).toEqual([true, ['objects']]);
    expect(parseObjectLink(text).hidden.length).toBeGreaterThan(80);
    expect(fittedLink(formatObjectLink({ ...NOTHING, picked: 'x'.repeat(5000) })).link).toBe('');
  });

  it.each(['1', '1,2,3', ',', 'a,b', '1,Infinity', ''])('has no range of "%s"', (text) => { expect(parseObjectLink(`by=a&between=${text}`).between).toBeNull(); });

  it('is found among the choices of others', () => {
    expect(linkOf('wires=on&object=a%26b&notes=xyz&hide=c&only=d&hider=1', 'objects')).toBe('object=a%26b&hide=c&only=d');
    expect(linkOf('wires=on&objects=3', 'objects')).toBe('');
    expect(linkOf('', 'objects')).toBe('');
  });
});

describe('what the address tells of objects', () => {
  it('is told once to those who follow, and put there once', () => {
    const put: string[] = [];
    const store = new ToolLink('object=a', (link) => { put.push(link); });
    let followed = 0;
    store.onFollow(() => { ++followed; });
    store.follow('object=a');
    store.write('object=a');
    expect([followed, put.length]).toEqual([0, 0]);
    store.write('');
    store.follow('object=b');
    store.follow('object=b');
    expect([followed, put, store.text]).toEqual([1, [''], 'object=b']);
  });
});
