// SPDX-License-Identifier: MIT
// Hosts that take a request and say nothing.
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { fetchBytes, type Fetch } from '../../src/hierarchy/bytes.js';
import { HierarchyProblem } from '../../src/hierarchy/problem.js';

/// Returns what comes of it after so many seconds.
async function after(seconds: number, fetch: Fetch, init?: RequestInit): Promise<unknown> {
  let outcome: unknown = 'nothing yet';
  fetchBytes(fetch, 'a.glb', 'a.glb', 1000, init).then((bytes) => { outcome = bytes; }, (problem: unknown) => { outcome = problem; });
  await vi.advanceTimersByTimeAsync(1000 * seconds);
  return outcome;
}

describe('a host', () => {
  beforeEach(() => { vi.useFakeTimers(); });
  afterEach(() => { vi.useRealTimers(); });

  it('that never answers is a problem that may pass, and its request is ended', async () => {
    let signal: AbortSignal | null = null;
    const never: Fetch = (_, init) => new Promise((_resolve, reject) => {
      signal = init!.signal!;
      signal.addEventListener('abort', () => { reject(new DOMException('ended', 'AbortError')); });
    });
    expect(await after(19, never)).toBe('nothing yet');
    const problem = await after(21, never);
    expect(problem).toBeInstanceOf(HierarchyProblem);
    expect(problem).toMatchObject({ message: 'a.glb: the host has sent nothing for 20 seconds', mayPass: true });
    expect(signal!.aborted).toBe(true);
  });

  it('that stops in the middle is one, too', async () => {
    let isCancelled = false;
    const stuck = new ReadableStream<Uint8Array>({ start: (stream) => { stream.enqueue(new Uint8Array(3)); }, cancel: () => { isCancelled = true; } });
    expect(await after(21, () => Promise.resolve(new Response(stuck)))).toMatchObject({ message: 'a.glb: the host has sent nothing for 20 seconds', mayPass: true });
    expect(isCancelled).toBe(true);
  });

  it('that is slow, but sends, is waited for', async () => {
    let pieces = 0;
    const slow = new ReadableStream<Uint8Array>({
      pull: async (stream) => {
        await new Promise((resolve) => setTimeout(resolve, 15_000));
        stream.enqueue(new Uint8Array(1));
        if (++pieces === 5) stream.close();
      },
    });
    expect(await after(80, () => Promise.resolve(new Response(slow)))).toEqual(new Uint8Array(5));
  });

  it('is no longer asked by who has gone', async () => {
    const ending = new AbortController();
    const never: Fetch = (_, init) => new Promise((_resolve, reject) => {
      init!.signal!.addEventListener('abort', () => { reject(init!.signal!.reason as Error); });
    });
    const left = after(1, never, { signal: ending.signal });
    ending.abort(new Error('gone'));
    expect(await left).toMatchObject({ message: 'gone' });
  });
});
