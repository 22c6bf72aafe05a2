// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { parseAddress } from '../../page/address.js';
import { compareAddress } from '../../page/pair/compare_address.js';
import { DEFAULT_PAIR, formatPairLook, readPairLook } from '../../page/pair/pair_link.js';
import { readQuery } from '../../page/query.js';

describe('links to two models', () => {
  it.each(['', 'way=side', 'way=blink&divider=0.25', 'divider=0', 'way=overlay&divider=1'])('keep %s', (choices) => {
    expect(formatPairLook(readPairLook(choices))).toBe(choices);
  });

  it.each(['way=', 'way=Swipe', 'way=constructor', 'divider=', 'divider=%20', 'divider=NaN', 'divider=-0.1', 'divider=1.01', 'divider=Infinity', 'divider=1,2'])('take %s for nothing', (choices) => {
    expect(readPairLook(choices)).toEqual(DEFAULT_PAIR);
  });
});

describe('the address of a comparison', () => {
  const compared = { url: 'http://host/show/models/a b.hier', other: 'https://other/x%26y.hier', story: null, pose: null, choices: '' };

  it('is read again', () => {
    const address = new URL(compareAddress('http://host/show/index.html?models=list.json&lang=de#models/a.hier', { ...compared, choices: 'way=side' }));
    const { only, other, problem } = readQuery(address.search, address.href);
    expect([only?.url, other?.url, problem]).toEqual(['http://host/show/models/a%20b.hier', compared.other, null]);
    expect(address.searchParams.get('lang')).toBe('de');
    expect(parseAddress(address.hash)).toEqual({ path: '', pose: null, choices: 'way=side' });
  });

  it('names no model where the page has it, and no other one where it ends', () => {
    expect(compareAddress('https://host/page.html', { ...compared, url: null })).toBe('https://host/page.html?with=https://other/x%2526y.hier');
    expect(compareAddress('https://host/page.html?with=a', { ...compared, url: null, other: null })).toBe('https://host/page.html');
  });
});
