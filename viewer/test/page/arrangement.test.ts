// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { arrangeModels, arrangeSlots, findJobs, tagsOf } from '../../page/gallery/arrangement.js';
import type { Wish } from '../../page/gallery/wish.js';
import { modelOfPath, type Model } from '../../page/listing.js';

function model(path: string, known: Partial<Model> = {}): Model {
  return { ...modelOfPath(path, 'http://host/models.json')!, ...known };
}

/// Names of groups, and in each the paths.
function arranged(models: readonly Model[], wish: Partial<Wish>): [string, string[]][] {
  return arrangeModels(models, { search: '', tag: '', order: 'folder', ...wish }).map(({ name, items }) => [name, items.map(({ path }) => path)]);
}

const MODELS = [
  model('models/b/x10.hier', { triangles: 5, bytes: 900, modified: 3 }),
  model('models/b/x9.hier', { triangles: 500, bytes: 90 }),
  model('models/a%20c/Éva.hier', { triangles: 50, modified: 7 }),
  model('models/root.hier', { modified: 7 }),
];

describe('models', () => {
  it('lie in groups by folder, without what all folders begin with', () => {
    expect(arranged(MODELS, {})).toEqual([
      ['', ['models/root.hier']],
      ['a c', ['models/a%20c/Éva.hier']],
      ['b', ['models/b/x9.hier', 'models/b/x10.hier']],
    ]);
    expect(arranged(MODELS.slice(0, 2), {})).toEqual([['', ['models/b/x9.hier', 'models/b/x10.hier']]]);
    expect(arranged([], {})).toEqual([]);
  });

  it.each([
    ['name', [2, 3, 1, 0]],
    ['newest', [2, 3, 0, 1]],
    ['size', [0, 1, 2, 3]],
    ['triangles', [1, 2, 0, 3]],
  ] as const)('are ordered by %s; what is not known comes last', (order, expected) => {
    expect(arranged(MODELS, { order })).toEqual([['', expected.map((i) => MODELS[i].path)]]);
  });

  it.each([['eva', [2]], ['EV', [2]], ['x b', [1, 0]], ['a c', [2]], ['nothing', []], ['.*', []]])('are found by "%s"', (search, expected) => {
    expect(arranged(MODELS, { search, order: 'name' })[0][1]).toEqual(expected.map((i) => MODELS[i].path));
  });

  it('have groups of their own, whatever folders are called', () => {
    const keys = arrangeModels(['a/b/1', 'a/b', 'c', 'a/b/%', '%/x', 'constructor/x'].map((path) => model(path)), { search: '', tag: '', order: 'folder' }).map(({ key }) => key);
    expect(new Set(keys).size).toBe(keys.length);
  });
});

describe('what people say of models', () => {
  const described = [model('a/1.hier', { folder: 'Florence/Statues', tags: ['marble', 'scan'] }), model('a/2.hier', { tags: ['scan'] }), model('b/3.hier')];

  it('is found, and groups them', () => {
    expect(arranged(described, {})).toEqual([['a', ['a/2.hier']], ['b', ['b/3.hier']], ['Florence/Statues', ['a/1.hier']]]);
    expect(arranged(described, { search: 'marb flor', order: 'name' })).toEqual([['', ['a/1.hier']]]);
    expect(arranged(described, { tag: 'scan', order: 'name' })).toEqual([['', ['a/1.hier', 'a/2.hier']]]);
    expect(arranged(described, { tag: 'sca', order: 'name' })).toEqual([['', []]]);
    expect(tagsOf(described)).toEqual([{ tag: 'scan', count: 2 }, { tag: 'marble', count: 1 }]);
  });

  it('groups slots as a server counts them', () => {
    const part = { total: 9, found: 4, first: 0, state: 's', tags: [], placed: 0, places: [] };
    expect(arrangeSlots([0, 1, 2, 3], { ...part, groups: [{ folder: 'm/a', count: 3 }, { folder: 'm/b', count: 1 }] }).map(({ name, items }) => [name, items])).toEqual([['a', [0, 1, 2]], ['b', [3]]]);
    expect(arrangeSlots([0, 1], { ...part, groups: [] })).toEqual([{ key: 'models', name: '', items: [0, 1] }]);
  });
});

it('jobs are found, in their order', () => {
  const jobs = ['b.ply', 'a.ply', 'ab.obj'].map((name) => ({ name, state: 'waiting', stage: '', progress: null, secondsLeft: null, message: '', preview: null }) as const);
  expect(findJobs(jobs, { search: 'B' }).map(({ name }) => name)).toEqual(['b.ply', 'ab.obj']);
});
