// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { readQuery } from '../../page/query.js';

const BASE = 'http://host/dir/index.html';

describe('the query', () => {
  it('may say nothing', () => {
    expect(readQuery('', BASE)).toEqual({ listing: 'http://host/dir/models.json', only: null, problem: null });
  });

  it('may name another listing', () => {
    expect(readQuery('?models=/x/list.json', BASE).listing).toBe('http://host/x/list.json');
  });

  it.each(['http://host/lists/', 'http://host/list?of=/x/'])('may name a listing at %s', (url) => {
    expect(readQuery(`?models=${encodeURIComponent(url)}`, BASE).listing).toBe(url);
  });

  it('may name one model', () => {
    expect(readQuery('?model=https://other/a/horse.hier', BASE).only).toMatchObject({ name: 'horse', url: 'https://other/a/horse.hier' });
  });

  it.each(['?model=', '?model=javascript:1', '?model=a.hier%3Fx', '?models=file:///etc/x', '?models=http://['])('is told off for %s', (search) => {
    expect(readQuery(search, BASE).problem!.message).toContain(search.split('=')[0]);
  });

  it('is told off in few words', () => {
    expect(readQuery(`?model=ftp://${'x'.repeat(1e5)}`, BASE).problem!.message.length).toBeLessThan(400);
  });
});
