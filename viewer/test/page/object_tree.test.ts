// SPDX-License-Identifier: MIT
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { readObjectFacts } from '../../src/hierarchy/object_facts.js';
import { ObjectTable } from '../../src/hierarchy/object_table.js';
import { JsonValue } from '../../src/json_value.js';
import { ObjectTree } from '../../page/tools/object_tree.js';
import { faked, fakePage } from '../support/fake_page.js';
import { plainRow } from '../support/object_words.js';
import { tableOfRows } from '../support/object_table.js';

describe('the tree of names', () => {
  beforeEach(() => { fakePage(); });
  afterEach(() => { vi.unstubAllGlobals(); });

  it('is there once it is opened again, after its table could not be read', async () => {
    const { bytes, json } = tableOfRows(['a', 'b/c', 'b/d'].map((name) => plainRow(name)), []);
    const facts = readObjectFacts(JsonValue.parse(JSON.stringify(json), (what) => { throw new Error(what); }));
    let isDown = true;
    const table = new ObjectTable(facts, (first, end) => (isDown ? Promise.reject(new Error('no answer')) : Promise.resolve(bytes.slice(first, end))));
    const failed = vi.fn();
    const tree = new ObjectTree({ visibility: () => 'shown', show: vi.fn(), alone: vi.fn(), fly: vi.fn(), pick: vi.fn(), failed });
    const rows = (): number => faked(faked(tree.root).children[0]).children.length;
    await tree.open(table);
    expect([failed.mock.calls.length, rows()]).toEqual([1, 0]);
    isDown = false;
    await tree.open(table);
    expect([failed.mock.calls.length, rows()]).toEqual([1, 2]);
  });
});
