// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import type { Pose } from '../../page/address.js';
import { modelOfPath } from '../../page/listing.js';
import { ModelEntry } from '../../page/model_entry.js';

const POSE: Pose = { position: [1, 2, 3], target: [0, 0, 0] };
const [A, B] = ['#a.hier', '#b.hier'];
const GALLERY = '';

/// A browser's history. Going is at once, but for `back()`, which only asks for it; no one is told of anything.
class FakeHistory {
  asked = 0;
  private at = 0;
  private readonly entries: { hash: string; state: unknown }[];
  readonly history: History;
  readonly location: Location;

  constructor(hash: string) {
    this.entries = [{ hash, state: null }];
    const entry = () => this.entries[this.at];
    this.history = {
      get state() { return entry().state; },
      replaceState: (state: unknown, _: string, hash?: string) => { Object.assign(entry(), hash === undefined ? { state } : { state, hash }); },
      back: () => { ++this.asked; },
    } as History;
    this.location = { get hash() { return entry().hash; } } as Location;
  }

  get hashes(): string[] {
    return this.entries.map(({ hash }) => hash);
  }

  push(hash: string): void {
    this.entries.splice(++this.at, Infinity, { hash, state: null });
  }

  go(delta: number): void {
    this.at += delta;
  }
}

function entryAt(page: FakeHistory, fromGallery: boolean): ModelEntry {
  const entry = new ModelEntry(modelOfPath('a.hier', 'http://host/models.json')!, 'a.hier', page);
  entry.arrive(fromGallery);
  return entry;
}

/// From the gallery to model A.
function opened(): { page: FakeHistory; entry: ModelEntry } {
  const page = new FakeHistory(GALLERY);
  page.push(A);
  return { page, entry: entryAt(page, true) };
}

describe('the history entry of a model', () => {
  it('keeps where the camera is', () => {
    const { page, entry } = opened();
    entry.write({ pose: POSE, choices: '' });
    expect(page.hashes).toEqual([GALLERY, `${A}&1,2,3,0,0,0`]);
    entry.write({ pose: null, choices: 'light=flat' });
    expect(page.hashes).toEqual([GALLERY, `${A}&light=flat`]);
    expect(entry.current).toBe(true);
  });

  it.each([null, POSE])('leaves the gallery\'s alone when the visitor is back there and the page is not told yet (%j)', (pose) => {
    const { page, entry } = opened();
    page.go(-1);
    expect(entry.current).toBe(false);
    entry.write({ pose, choices: '' });
    expect(entry.leave()).toBe(true);
    expect(page.hashes).toEqual([GALLERY, A]);
    expect(page.asked).toBe(0);
  });

  it('leaves other models\' alone, and its own ones where the camera was elsewhere', () => {
    const { page, entry } = opened();
    for (const hash of [B, `${A}&4,5,6,0,0,0`]) {
      page.push(hash);
      entry.write({ pose: POSE, choices: '' });
      expect(page.hashes).toEqual([GALLERY, A, hash]);
      page.go(-1);
    }
    entry.write({ pose: POSE, choices: '' });
    expect(page.hashes[1]).toBe(`${A}&1,2,3,0,0,0`);
  });

  it('leads back to the gallery once, and keeps nothing on the way', () => {
    const { page, entry } = opened();
    expect(entry.leave()).toBe(true);
    expect(entry.leave()).toBe(true);
    expect(page.asked).toBe(1);
    entry.write({ pose: POSE, choices: '' });
    page.go(-1);
    entry.write({ pose: POSE, choices: '' });
    expect(page.hashes).toEqual([GALLERY, A]);
  });

  it('does not lead back to the gallery if the model was there first', () => {
    const page = new FakeHistory(A);
    expect(entryAt(page, false).leave()).toBe(false);
    page.push(GALLERY);
    page.go(-1);
    expect(entryAt(page, true).leave()).toBe(false); // the gallery is shown, but comes after it
    expect(page.asked).toBe(0);
  });

  it('is another one where the address names another camera', () => {
    const { page, entry } = opened();
    page.push(`${A}&4,5,6,0,0,0`);
    entry.arrive(false);
    expect(entry.leave()).toBe(false);
    entry.write({ pose: POSE, choices: '' });
    expect(page.hashes).toEqual([GALLERY, A, `${A}&1,2,3,0,0,0`]);
    page.go(-1);
    entry.arrive(false);
    expect(entry.leave()).toBe(true);
    expect(page.asked).toBe(1);
  });

  it('can be left again when the visitor is there again', () => {
    const { page, entry } = opened();
    entry.leave();
    entry.arrive(false);
    entry.write({ pose: POSE, choices: '' });
    expect(page.hashes[1]).toBe(`${A}&1,2,3,0,0,0`);
    entry.leave();
    expect(page.asked).toBe(2);
  });
});
