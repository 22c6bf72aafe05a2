// SPDX-License-Identifier: MIT
// A page has a model within it, and goes on with what its host has.
import { gzipSync } from 'node:zlib';
import { afterEach, describe, expect, it, vi } from 'vitest';
import { embeddedModel, EmbeddedFiles } from '../../page/embedded.js';
import { HierarchyProblem } from '../../src/hierarchy/problem.js';
import type { RemoteFiles } from '../../src/hierarchy/files.js';

const TEXT = new TextEncoder().encode('0123456789'.repeat(10));
const { signal } = new AbortController();

function base64(bytes: Uint8Array): string {
  return Buffer.from(bytes).toString('base64');
}

/// A page with that in it.
function pageWith(content: unknown): Pick<Document, 'getElementById' | 'baseURI'> {
  const textContent = typeof content === 'string' ? content : JSON.stringify(content);
  return { baseURI: 'file:///a/david.html', getElementById: () => ({ textContent }) as HTMLElement };
}

/// Plays a host whose files are their own names.
function link(fails: () => unknown = () => null): RemoteFiles & { asked: string[] } {
  const asked: string[] = [];
  const answer = (name: string): Promise<Uint8Array<ArrayBuffer>> => {
    asked.push(name);
    const problem: unknown = fails();
    return problem instanceof Error ? Promise.reject(problem) : Promise.resolve(new TextEncoder().encode(name));
  };
  return { asked, stored: answer, part: answer, manifestNow: () => answer('hierarchy.json') };
}

afterEach(() => { vi.useRealTimers(); });

describe('the hierarchy in a page', () => {
  it('is none in a page without it', () => {
    expect(embeddedModel({ baseURI: 'http://host/', getElementById: () => null })).toBeNull();
  });

  it('has a name, files, and perhaps a link', async () => {
    const model = embeddedModel(pageWith({ name: 'david', files: { 'a.bin': base64(TEXT) } }))!;
    expect(model).toMatchObject({ name: 'david', url: 'file:///a/david.html' });
    expect(await model.files!.stored('a.bin', 100)).toEqual(TEXT);
    expect(embeddedModel(pageWith({ name: 'david', link: 'https://host/david.3tz', files: {} }))!.url).toBe('https://host/david.3tz');
  });

  it.each(['', '[]', '{}', '{"name":"a"}', '{"name":1,"files":{}}', '{"name":"a","files":[]}', '{"name":"a","files":{"b":1}}'])('%s is damaged', (text) => {
    expect(() => embeddedModel(pageWith(text))).toThrow('this page is damaged');
  });

  it('gives files out of their gzip, and parts of them', async () => {
    const files = new EmbeddedFiles(new Map([['a', base64(TEXT)], ['b', base64(gzipSync(TEXT))]]), null);
    for (const name of ['a', 'b']) {
      expect(await files.stored(name, 100)).toEqual(TEXT);
      expect(await files.part(name, [5, 15], 1000, signal)).toEqual(TEXT.subarray(5, 15));
      await expect(files.part(name, [95, 105], 1000, signal)).rejects.toThrow(`${name}: is not in this page`);
    }
    await expect(files.stored('b', 99)).rejects.toThrow('b: larger than 99 bytes');
    await expect(files.stored('c', 100)).rejects.toThrow('c: is not in this page');
    expect([files.lacks('a'), files.lacks('c')]).toEqual([false, true]);
  });

  it('goes on with the link', async () => {
    const rest = link();
    const files = new EmbeddedFiles(new Map([['a', base64(TEXT)]]), rest);
    expect(files.lacks('c')).toBe(false);
    expect(new TextDecoder().decode(await files.stored('c', 100))).toBe('c');
    await files.part('a', [95, 105], 1000, signal);
    await files.stored('a', 100);
    expect(rest.asked).toEqual(['c', 'a']);
  });

  it('does without the link for a while where the line fails', async () => {
    vi.useFakeTimers();
    const files = new EmbeddedFiles(new Map(), link(() => new HierarchyProblem('c', 'could not be fetched', true)));
    await expect(files.stored('c', 100)).rejects.toThrow('could not be fetched');
    expect(files.lacks('c')).toBe(true);
    vi.advanceTimersByTime(31_000);
    expect(files.lacks('c')).toBe(false);
  });

  it('keeps a link of which a file is broken', async () => {
    const files = new EmbeddedFiles(new Map(), link(() => new HierarchyProblem('c', 'is damaged')));
    await expect(files.stored('c', 100)).rejects.toThrow('is damaged');
    expect(files.lacks('c')).toBe(false);
  });
});
