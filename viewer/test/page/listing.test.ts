// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { ListingError, modelOfPath, parseListing, resolveUrl, withoutWarnings, type Listing } from '../../page/listing.js';
import { nameOfPath } from '../../page/path_name.js';
import { maySend } from '../../page/upload/permission.js';

const URL_ = 'http://host/dir/models.json';

function parse(document: unknown) {
  return parseListing(JSON.stringify(document), URL_);
}

describe('a listing', () => {
  it('gives its models and jobs', () => {
    const david = { name: 'david', path: 'models/sub/david.hier', vertices: 5, triangles: 8, bytes: 900, source: 'david.ply', modified: 1_790_000_000, preview: 'models/sub/david.hier/preview.webp', story: 'models/sub/david.hier.story.json' };
    const job = { name: 'x.ply', state: 'building', stage: 'partition', progress: 0.42, seconds_left: 12, preview: '/x.webp' };
    const { models, jobs } = parse({ models: [david], jobs: [job] });
    expect(models).toEqual([{ ...david, url: 'http://host/dir/models/sub/david.hier', preview: 'http://host/dir/models/sub/david.hier/preview.webp', story: 'http://host/dir/models/sub/david.hier.story.json' }]);
    expect(jobs).toEqual([{ name: 'x.ply', state: 'building', stage: 'partition', progress: 0.42, secondsLeft: 12, message: '', preview: 'http://host/x.webp' }]);
  });

  it('needs no more than paths', () => {
    const [model] = parse({ models: [{ path: 'a b/c.d.hier/' }] }).models;
    expect(model).toMatchObject({ name: 'c.d', url: 'http://host/dir/a%20b/c.d.hier', vertices: null, bytes: null });
  });

  it('has jobs only if it says so', () => {
    expect(parse({ models: [] }).jobs).toBeNull();
    expect(parse({ models: [], jobs: [] }).jobs).toEqual([]);
  });

  it('has what people say of models', () => {
    const [model, other] = parse({ models: [{ path: 'a.hier', name: 'a', title: 'Anna', folder: 'x/y', tags: ['t', 5, ''], place: [7.5, -50] }, { path: 'b.hier', tags: 'x', place: [200, 0] }] }).models;
    expect(model).toMatchObject({ name: 'Anna', folder: 'x/y', tags: ['t'], place: [7.5, -50] });
    expect(['folder', 'tags', 'place'].some((key) => key in other)).toBe(false);
  });

  it('may be a part of a longer one, or go on elsewhere', () => {
    const whole = { total: 10_000, found: 500, first: 0, state: 'ab', groups: [{ folder: 'x', count: 500 }, 5], tags: [{ tag: 't', count: 3 }], placed: 2, places: [[7, 50, 3], [1], [999, 0, 1]] };
    expect(parse({ models: [], ...whole }).part).toEqual({ ...whole, groups: [{ folder: 'x', count: 500 }], places: [[7, 50, 3]] });
    for (const broken of [{ found: undefined }, { found: 1e12 }, { state: 5 }, { total: -1 }]) expect(parse({ models: [], ...whole, ...broken }).part).toBeNull();
    expect(parse({ models: [], parts: ['listing/1.json', 'javascript:x', 7] }).parts).toEqual(['http://host/dir/listing/1.json']);
  });

  it.each(['', '{', 'null', '[]', '5', '{}', '{"models":{}}', '{"models":"x"}'])('is refused as %s', (text) => {
    expect(() => parseListing(text, URL_)).toThrow(ListingError);
  });

  it('leaves out entries that are none', () => {
    const bad = [null, 5, 'x', [], {}, { path: 5 }, { path: '' }, { path: 'javascript:alert(1)' }, { path: 'http://[' },
      { path: 'data:text/html,x' }, { path: { toString: 'x' } }];
    expect(parse({ models: bad, jobs: [null, {}, { state: 'done' }, 7] })).toEqual({ models: [], part: null, parts: [], jobs: [], folder: null, inbox: null, upload: null });
  });

  it('says whether meshes are taken', () => {
    expect(parse({ models: [], upload: { limit: 1000, token: true, views: false } }).upload).toEqual({ limit: 1000, token: true, views: false });
    expect(parse({ models: [], upload: { limit: 0 } }).upload).toEqual({ limit: 0, token: false, views: false });
    for (const upload of [true, 5, [], {}, { limit: -1 }, { limit: '5' }, { token: true, views: false }]) expect(parse({ models: [], upload }).upload).toBeNull();
  });

  it('says where the models lie', () => {
    expect(parse({ models: [], folder: 'models', inbox: 5 })).toMatchObject({ folder: 'models', inbox: null });
  });

  it('leaves out values that are none', () => {
    const [model] = parse({ models: [{ path: 'a', name: { x: 1 }, vertices: '7', triangles: -3, bytes: null, source: 4, modified: '1', preview: 'javascript:1' }] }).models;
    expect(model).toMatchObject({ name: 'a', vertices: null, triangles: null, bytes: null, source: null, modified: null, preview: null });
    const [job] = parse({ models: [], jobs: [{ state: 'failed', progress: 7, stage: [], seconds_left: 'soon', message: {}, preview: 'data:image/png,x' }] }).jobs!;
    expect(job).toEqual({ name: 'a mesh without a name', state: 'failed', stage: '', progress: 1, secondsLeft: null, message: '', preview: null });
  });

  it('is kept within bounds', () => {
    const path = 'a'.repeat(10);
    expect(parse({ models: [{ path, name: 'n'.repeat(1e6) }] }).models[0].name).toHaveLength(1000);
    expect(parse({ models: Array.from({ length: 20_000 }, (_, i) => ({ path: String(i) })) }).models).toHaveLength(10_000);
  });

  it('has a path once', () => {
    expect(parse({ models: [{ path: 'a', name: 'one' }, { path: 'a', name: 'two' }] }).models.map(({ name }) => name)).toEqual(['one']);
  });
});

describe('a path', () => {
  it.each([['a.hier', 'a'], ['x/y.z.hier/', 'y.z'], ['http://h/q%3F.hier', 'q?'], ['.hier', '.hier'], ['/', '/']])('%s is named %s', (path, name) => {
    expect(nameOfPath(path)).toBe(name);
  });

  it('is called as people read it, in links too', () => {
    expect(modelOfPath('a/x%3Fy%20%C3%BC.hier', URL_)).toMatchObject({ name: 'x?y ü', url: 'http://host/dir/a/x%3Fy%20%C3%BC.hier' });
    expect(nameOfPath('100%.hier')).toBe('100%');
  });

  it('may lead to another host, and nowhere but to hosts', () => {
    expect(modelOfPath('https://other/a.hier', URL_)?.url).toBe('https://other/a.hier');
    expect(modelOfPath('blob:http://host/1', URL_)).toBeNull();
  });

  it('may have slashes at its end, and a thousand characters', () => {
    expect(modelOfPath('a.hier///', URL_)?.url).toBe('http://host/dir/a.hier');
    expect(modelOfPath('a.3tz', URL_)?.url).toBe('http://host/dir/a.3tz');
    expect(modelOfPath('a.3tz//', URL_)?.url).toBe('http://host/dir/a.3tz/');
    expect(modelOfPath('https://bucket/a.3tz?signature=1', URL_)?.url).toBe('https://bucket/a.3tz?signature=1');
    expect(modelOfPath('a'.repeat(1000), URL_)).not.toBeNull();
    expect(modelOfPath('a'.repeat(1001), URL_)).toBeNull();
  });

  it.each(['a.hier?x=/y', 'http://h/a.hier?', 'a.hier#', 'a#b/c.hier', '?', '#a'])('cannot be %s: the names of files follow it', (path) => {
    expect(modelOfPath(path, URL_)).toBeNull();
    expect(parse({ models: [{ path }] }).models).toEqual([]);
  });

  it('is read whatever slashes it has', () => {
    const slashes = `a${'/'.repeat(100_000)}x`;
    expect(nameOfPath(slashes)).toBe('x');
    expect(resolveUrl(slashes, URL_)).toHaveLength('http://host/dir/'.length + slashes.length);
    expect(parse({ models: [{ path: slashes }] }).models).toEqual([]);
  });
});

describe('warnings of a build', () => {
  const listed = (warnings: unknown): Listing => parseListing(JSON.stringify({ models: [{ path: 'a.hier', warnings }] }), 'http://host/models.json');

  it('are texts, and so many', () => {
    expect(listed(['one', 7, '', null, 'two']).models[0].warnings).toEqual(['one', 'two']);
    expect(listed(Array.from({ length: 1000 }, () => 'x'.repeat(2000))).models[0].warnings!.map(({ length }) => length)).toEqual(Array.from({ length: 100 }, () => 1000));
    for (const none of [undefined, null, 'x', [], {}, [7]]) expect(listed(none).models[0]).not.toHaveProperty('warnings');
  });

  it('are none for those who only look', () => {
    expect(withoutWarnings(listed(['one'])).models).toEqual(listed(undefined).models);
  });

  it.each([
    [null, 'localhost', true], [null, '127.0.0.1', true], [null, '[::1]', true], [null, 'museum.example', false],
    [{ limit: 1, token: false, views: false }, 'museum.example', true], [{ limit: 1, token: true, views: false }, 'museum.example', false],
  ])('are for those who may send meshes: %j at %s: %s', (offer, hostname, may) => {
    expect(maySend(offer, `http://${hostname}/models.json`, { origin: `http://${hostname}`, hostname })).toBe(may);
    expect(maySend(offer, 'http://other/models.json', { origin: `http://${hostname}`, hostname })).toBe(false);
  });
});
