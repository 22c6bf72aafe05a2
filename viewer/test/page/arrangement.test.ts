// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { arrangeModels, findJobs, type Wish } from '../../page/gallery/arrangement.js';
import { modelOfPath, type Model } from '../../page/listing.js';

function model(path: string, known: Partial<Model> = {}): Model {
  return { ...modelOfPath(path, 'http://host/models.json')!, ...known };
}

/// Names of groups, and in each the paths.
function arranged(models: readonly Model[], wish: Partial<Wish>): [string, string[]][] {
  return arrangeModels(models, { search: '', order: 'folder', ...wish }).map(({ name, items }) => [name, items.map(({ path }) => path)]);
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
    const keys = arrangeModels(['a/b/1', 'a/b', 'c', 'a/b/%', '%/x', 'constructor/x'].map((path) => model(path)), { search: '', order: 'folder' }).map(({ key }) => key);
    expect(new Set(keys).size).toBe(keys.length);
  });
});

it('jobs are found, in their order', () => {
  const jobs = ['b.ply', 'a.ply', 'ab.obj'].map((name) => ({ name, state: 'waiting', stage: '', progress: null, secondsLeft: null, message: '', preview: null }) as const);
  expect(findJobs(jobs, { search: 'B', order: 'name' }).map(({ name }) => name)).toEqual(['b.ply', 'ab.obj']);
});
