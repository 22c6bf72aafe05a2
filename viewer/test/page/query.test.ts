// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { readQuery } from '../../page/query.js';

const BASE = 'http://host/dir/index.html';

describe('the query', () => {
  it('may say nothing', () => {
    expect(readQuery('', BASE)).toEqual({ other: null, listing: 'http://host/dir/models.json', only: null, problem: null });
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

  it.each(['?model=a.hier', '?model=https://bucket.example/a.3tz', '?model=https://bucket.example/a.3tz%3Fsignature=x', '?model=a.hier&lang=de'])('has no story unless it names one: %s', (search) => {
    expect(readQuery(search, BASE)).toMatchObject({ only: { story: null }, problem: null });
  });

  it('may name a story', () => {
    expect(readQuery('?model=a.hier&story=a.hier.story.json', BASE)).toMatchObject({ only: { story: 'http://host/dir/a.hier.story.json' }, problem: null });
  });

  it.each(['&story=', '&story=%20', '&story=ftp://x/y', '&story=javascript:1', '&story=http://['])('shows the model, and is told off, for %s', (story) => {
    const { only, problem } = readQuery(`?model=a.hier${story}`, BASE);
    expect(only).toMatchObject({ url: 'http://host/dir/a.hier', story: null });
    expect(problem!.message).toContain('&story=');
  });

  it('may name another model to compare with', () => {
    expect(readQuery('?model=a.hier&with=sub/b.3tz', BASE)).toMatchObject({ only: { url: 'http://host/dir/a.hier' }, other: { name: 'b', url: 'http://host/dir/sub/b.3tz' }, problem: null });
  });

  it.each(['&with=', '&with=%20', '&with=ftp://x/y', '&with=javascript:1', '&with=b.hier%3Fx', '&with=http://[', `&with=${'x'.repeat(2000)}`])('shows the model alone, and is told off, for %s', (other) => {
    const query = readQuery(`?model=a.hier${other}`, BASE);
    expect(query).toMatchObject({ only: { url: 'http://host/dir/a.hier' }, other: null });
    expect(query.problem!.message).toContain('&with=');
    expect(query.problem!.message.length).toBeLessThan(400);
  });

  it('needs a model to compare another one with', () => {
    expect(readQuery('?with=b.hier', BASE)).toMatchObject({ only: null, other: null, problem: { more: '' } });
    expect(readQuery('?with=b.hier', BASE, readQuery('?model=a.hier', BASE).only)).toMatchObject({ only: { name: 'a' }, other: { name: 'b' }, problem: null });
  });

  it.each(['?models=', '?models=%20', '?model=%20', '?model=', '?model=javascript:1', '?model=a.hier%3Fx', '?models=file:///etc/x', '?models=http://['])('is told off for %s', (search) => {
    expect(readQuery(search, BASE).problem!.message).toContain(search.split('=')[0]);
  });

  it('is told off in few words', () => {
    expect(readQuery(`?model=ftp://${'x'.repeat(1e5)}`, BASE).problem!.message.length).toBeLessThan(400);
  });
});
