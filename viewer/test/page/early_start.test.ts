// SPDX-License-Identifier: MIT
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { EarlyStart } from '../../page/early_start.js';

const ROOT = 'http://host/a.hier/tiles/00/000000.glb';

class FakeWorker extends EventTarget {
  ended = false;
  terminate(): void { this.ended = true; }
}

function workerOf(early: EarlyStart): FakeWorker {
  return early.createWorker() as unknown as FakeWorker;
}

const asked: { url: string; signal: AbortSignal | null | undefined }[] = [];

beforeEach(() => {
  asked.length = 0;
  vi.stubGlobal('Worker', FakeWorker);
  vi.stubGlobal('fetch', (url: string, init?: RequestInit) => {
    asked.push({ url, signal: init?.signal });
    return Promise.resolve(new Response(url));
  });
});

afterEach(() => { vi.unstubAllGlobals(); });

describe('an early start', () => {
  it('asks for the root once', async () => {
    const early = new EarlyStart('http://host/a.hier');
    expect(await (await early.fetch(ROOT)).text()).toBe(ROOT);
    await early.fetch('http://host/a.hier/hierarchy.json');
    early.close();
    expect(asked.map(({ url }) => url)).toEqual([ROOT, 'http://host/a.hier/hierarchy.json']);
    expect(asked[0].signal?.aborted).toBe(false);
  });

  it('asks for the beginning of an archive', async () => {
    const early = new EarlyStart('http://host/a.3tz');
    await early.fetch('http://host/a.3tz');
    await early.fetch('http://host/a.3tz');
    early.close();
    expect(asked.map(({ url }) => url)).toEqual(['http://host/a.3tz', 'http://host/a.3tz']);
  });

  it('ends the root with whoever took it', async () => {
    const early = new EarlyStart('http://host/a.hier');
    const taker = new AbortController();
    await early.fetch(ROOT, { signal: taker.signal });
    early.close();
    expect(asked[0].signal?.aborted).toBe(false);
    taker.abort();
    expect(asked[0].signal?.aborted).toBe(true);
  });

  it('ends the root if whoever took it was at its end', async () => {
    const early = new EarlyStart('http://host/a.hier');
    await early.fetch(ROOT, { signal: AbortSignal.abort() });
    expect(asked[0].signal?.aborted).toBe(true);
  });

  it('ends what nobody took', async () => {
    const early = new EarlyStart('http://host/a.hier');
    early.close();
    expect(asked[0].signal?.aborted).toBe(true);
    await early.fetch(ROOT);
    expect(asked).toHaveLength(2);
  });

  it('leaves a worker that was taken alone', () => {
    const early = new EarlyStart('http://host/a.hier');
    const [first, second] = [workerOf(early), workerOf(early)];
    expect(first).not.toBe(second);
    early.close();
    expect([first.ended, second.ended]).toEqual([false, false]);
  });

  it('does not hand over a worker that failed', () => {
    const made: FakeWorker[] = [];
    vi.stubGlobal('Worker', class extends FakeWorker {
      constructor() {
        super();
        made.push(this);
      }
    });
    const early = new EarlyStart('http://host/a.hier');
    made[0].dispatchEvent(new Event('error'));
    expect(workerOf(early)).toBe(made[1]);
  });
});
