// SPDX-License-Identifier: MIT
import { describe, expect, it, vi } from 'vitest';
import { PagedModels } from '../../page/gallery/paged_models.js';
import { PART, partAddress } from '../../page/gallery/wish.js';
import { modelOfPath, type Listing, type ListingPart } from '../../page/listing.js';

const WHOLE = 500;

function part(first: number, state: string): ListingPart {
  return { total: 900, found: WHOLE, first, state, groups: [], tags: [], placed: 0, places: [] };
}

function listing(first: number, state = 's'): Listing {
  const models = Array.from({ length: Math.min(PART, WHOLE - first) }, (_, i) => modelOfPath(`${first + i}.hier`, 'http://host/models.json')!);
  return { models, part: part(first, state), parts: [], jobs: null, folder: null, inbox: null, upload: null };
}

function pagedBy(fetchPart: (first: number) => Promise<Listing>): { paged: PagedModels; came: () => void; outdated: () => void } {
  const [came, outdated] = [vi.fn(), vi.fn()];
  const first = listing(0);
  return { paged: new PagedModels(first.part!, first.models, fetchPart, came, outdated), came, outdated };
}

const turn = (): Promise<void> => new Promise((resolve) => { setTimeout(resolve); });

describe('models in parts', () => {
  it('have slots, which ask for their part once', async () => {
    const asked: number[] = [];
    const { paged, came } = pagedBy((first) => (asked.push(first), Promise.resolve(listing(first))));
    expect([paged.slots.length, paged.slots[0]?.path, paged.slots[PART]]).toEqual([WHOLE, '0.hier', null]);
    for (const index of [0, 499, 485, 130]) paged.need(index);
    await turn();
    expect(asked).toEqual([480, 120]);
    expect(came).toHaveBeenCalledTimes(2);
    expect([paged.slots[499]?.path, paged.slots[239]?.path, paged.slots[240]]).toEqual(['499.hier', '239.hier', null]);
    expect((await paged.at([1, 300])).map(({ path }) => path)).toEqual(['1.hier', '300.hier']);
  });

  it('of another listing are not taken', async () => {
    const { paged, came, outdated } = pagedBy((first) => Promise.resolve(listing(first, 'another')));
    paged.need(200);
    await turn();
    expect(paged.slots[200]).toBeNull();
    expect(outdated).toHaveBeenCalledTimes(1);
    expect(came).not.toHaveBeenCalled();
  });

  it('are asked for again after a failure, and not told of once it is closed', async () => {
    let tries = 0;
    const { paged, came } = pagedBy((first) => (++tries === 1 ? Promise.reject(new Error('gone')) : Promise.resolve(listing(first))));
    paged.need(200);
    await turn();
    expect(paged.slots[200]).toBeNull();
    paged.need(200);
    paged.close();
    await turn();
    expect([tries, paged.slots[200]]).toEqual([2, null]);
    expect(came).not.toHaveBeenCalled();
  });
});

describe('the address of a part', () => {
  it('says what is looked for; a signed one stays as it is', () => {
    expect(partAddress('http://h/models.json', { search: 'a b&c', tag: '', order: 'newest' }, { first: '120' })).toBe('http://h/models.json?count=120&order=newest&search=a+b%26c&first=120');
    expect(partAddress('http://h/models.json?sign=1', { search: 'a', tag: '', order: 'name' })).toBe('http://h/models.json?sign=1');
  });
});
