// SPDX-License-Identifier: MIT
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { ListingWatch } from '../../page/listing_watch.js';

const URL_ = 'http://host/models.json';
const PAUSE = 2000;
const LONG = 60_000; // longer than anything is waited for

type Answer = Response | Error | Promise<Response>;

function listing(name: string, jobs?: object[]): Response {
  return new Response(JSON.stringify({ models: [{ path: name }], jobs }));
}

/// Never answers, as a host that hangs.
function silence(): Promise<Response> {
  return new Promise(() => undefined);
}

/// `name` when it is asked to.
function later(name: string): { answer: Promise<Response>; come(): void } {
  let come = (): void => undefined;
  const answer = new Promise<Response>((resolve) => { come = () => { resolve(listing(name, [])); }; });
  return { answer, come };
}

const page = { hidden: false };
let told: string[] = [];
let asked: RequestInit['signal'][] = [];

/// Plays a host with these answers, one after the other, the last one for ever.
function watchOf(...answers: (() => Answer)[]): ListingWatch {
  vi.stubGlobal('fetch', async (_: string, { signal }: RequestInit) => {
    const answer = answers[Math.min(asked.push(signal), answers.length) - 1]();
    if (answer instanceof Error) throw answer;
    return Promise.race([answer, new Promise<Response>((_, reject) => {
      signal?.addEventListener('abort', () => { reject(signal.reason as Error); });
    })]);
  });
  return new ListingWatch(URL_, ({ models }) => { told.push(models[0].path); }, (message) => { told.push(message); });
}

/// For so many milliseconds of the clock; what streams bring takes none of them.
async function wait(milliseconds: number): Promise<void> {
  await vi.advanceTimersByTimeAsync(milliseconds);
  for (let turn = 0; turn < 20; ++turn) await new Promise((resolve) => { setImmediate(resolve); });
}

beforeEach(() => {
  [told, asked, page.hidden] = [[], [], false];
  vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout'] });
  vi.stubGlobal('window', globalThis);
  vi.stubGlobal('document', page);
});

afterEach(() => {
  vi.unstubAllGlobals();
  vi.useRealTimers();
});

describe('the watch of a listing', () => {
  it('looks once at one without jobs', async () => {
    watchOf(() => listing('a')).start();
    await wait(LONG);
    expect([told, asked.length]).toEqual([['a'], 1]);
  });

  it('looks again while it has jobs, and tells what is new', async () => {
    watchOf(() => listing('a', []), () => listing('a', []), () => listing('b', [])).start();
    for (let look = 0; look < 4; ++look) await wait(PAUSE);
    expect(asked.length).toBeGreaterThanOrEqual(4);
    expect(told).toEqual(['a', 'b']);
  });

  it('looks again until there is one', async () => {
    watchOf(() => new Error('refused'), () => new Response(null, { status: 503, statusText: 'Busy' }), () => listing('a')).start();
    for (let look = 0; look < 4; ++look) await wait(PAUSE);
    expect([told, asked.length]).toEqual([[`${URL_} cannot be reached`, `${URL_}: 503 Busy`, 'a'], 3]);
  });

  it('does not wait for ever', async () => {
    watchOf(silence, () => listing('a')).start();
    await wait(LONG);
    expect(told).toEqual([`${URL_} cannot be reached`, 'a']);
  });

  it('goes on when a later look hangs', async () => {
    watchOf(() => listing('a', []), silence, () => listing('b', [])).start();
    await wait(PAUSE);
    await wait(LONG);
    await wait(PAUSE);
    expect(told).toEqual(['a', 'b']);
  });

  it('rests while the page is hidden', async () => {
    watchOf(() => listing('a', []), () => listing('b', [])).start();
    await wait(0);
    page.hidden = true;
    await wait(LONG);
    expect(asked).toHaveLength(1);
    page.hidden = false;
    await wait(PAUSE);
    expect(told).toEqual(['a', 'b']);
  });

  it('gives up what is on its way when it stops', async () => {
    const watch = watchOf(silence);
    watch.start();
    watch.stop();
    await wait(LONG);
    expect(asked.map((signal) => signal?.aborted)).toEqual([true]);
    expect(told).toEqual([]);
  });

  it('hears nothing of an earlier start', async () => {
    const [old, young] = [later('old'), later('young')];
    const answers = [old.answer, young.answer];
    const watch = watchOf(silence);
    vi.stubGlobal('fetch', () => answers.shift() ?? silence()); // one that cannot be given up
    watch.start();
    watch.start();
    young.come();
    await wait(0);
    old.come();
    await wait(0);
    expect(told).toEqual(['young']);
    watch.stop();
  });

  it('takes no more than 16 MiB', async () => {
    let sent = 0;
    const endless = new ReadableStream<Uint8Array>({
      pull(to) {
        to.enqueue(new Uint8Array(2 ** 20).fill(32));
        sent += 2 ** 20;
        if (sent === 2 ** 26) to.close();
      },
    });
    watchOf(() => new Response(endless), silence).start();
    await wait(0);
    await wait(0);
    expect(told).toEqual([`${URL_}: larger than 16777216 bytes`]);
    expect(sent).toBeLessThan(2 ** 25);
  });
});
