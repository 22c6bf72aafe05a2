// SPDX-License-Identifier: MIT
import { afterEach, describe, expect, it, vi } from 'vitest';
import { droppedFiles } from '../../page/upload/chosen_files.js';
import type { Upload } from '../../page/upload/plan.js';
import { RateMeter } from '../../page/upload/rate.js';
import { refusalText, requestOf, send, type ServerAnswer } from '../../page/upload/send.js';
import { progressText } from '../../page/upload/upload_row.js';

const SCAN = new File(['mesh'], 'scan.ply');

function upload(name: string, ...names: string[]): Upload {
  return { name, files: names.map((each) => ({ name: each, file: SCAN })), isFolder: names.length > 1, bytes: 4 };
}

describe('the rate', () => {
  it('is unknown at first, then that of the last seconds', () => {
    const meter = new RateMeter();
    expect(meter.rate).toBeNull();
    meter.note(0, 0);
    expect(meter.rate).toBeNull();
    for (let second = 1; second <= 10; ++second) meter.note(1000 * second, second <= 5 ? 100 * second : 500 + 10 * (second - 5));
    expect(meter.rate).toBe(10);
    expect(meter.secondsTo(650)).toBe(10);
  });

  it('tells no time while nothing goes on', () => {
    const meter = new RateMeter();
    meter.note(0, 7);
    meter.note(1000, 7);
    expect(meter.secondsTo(100)).toBeNull();
  });
});

describe('the progress', () => {
  it('has amounts, then rate and time, then the saving', () => {
    const meter = new RateMeter();
    meter.note(0, 0);
    expect(progressText(0, 4e6, meter)).toBe('0 byte of 4.00 MB');
    meter.note(1000, 1e6);
    expect(progressText(1e6, 4e6, meter)).toBe('1.00 MB of 4.00 MB, 1.00 MB/s, 3 sec left');
    expect(progressText(4e6, 4e6, meter)).toBe('is being saved');
  });
});

describe('a refusal', () => {
  it.each([
    [0, '', /connection broke off; a\.ply/],
    [409, 'x', /a\.ply is in the inbox already/],
    [507, 'x', /no room for a\.ply/],
    [403, 'Pages of others may not.', /a\.ply was not taken: Pages of others may not\./],
    [502, '', /a\.ply was not taken: 502/],
  ])('of status %i "%s" is %s', (status, text, said) => { expect(refusalText('a.ply', { status, text })).toMatch(said); });
});

describe('a request', () => {
  it('is the file itself', () => {
    expect(requestOf(upload('Süd 1.ply', 'Süd 1.ply'))).toEqual({ method: 'PUT', path: 'S%C3%BCd%201.ply', body: SCAN });
  });

  it('is a form of files that belong together', () => {
    const { method, path, body } = requestOf(upload('house', 'house.obj', 'wall.png'));
    expect([method, path]).toEqual(['POST', 'house']);
    expect((body as FormData).getAll('file').map((file) => (file as File).name)).toEqual(['house.obj', 'wall.png']);
  });
});

/// A server's side of XMLHttpRequest.
class FakeRequest extends EventTarget {
  static last: FakeRequest;
  upload = new EventTarget();
  status = 0;
  responseText = '';
  sent: unknown[] = [];
  constructor() {
    super();
    FakeRequest.last = this;
  }
  open(...given: unknown[]): void { this.sent.push(...given); }
  setRequestHeader(...given: unknown[]): void { this.sent.push(...given); }
  send(body: unknown): void { this.sent.push(body); }
  abort(): void { this.dispatchEvent(new Event('abort')); }
  answer(status: number, text: string): void {
    Object.assign(this, { status, responseText: text });
    this.dispatchEvent(new Event('load'));
  }
}

describe('sending', () => {
  afterEach(() => { vi.unstubAllGlobals(); });

  function begin(token: string | null): { answer: Promise<ServerAnswer | null>; ending: AbortController; told: number[][] } {
    vi.stubGlobal('XMLHttpRequest', FakeRequest);
    const ending = new AbortController();
    const told: number[][] = [];
    const answer = send(upload('a.ply', 'a.ply'),
      { inbox: 'http://host/inbox/', token, told: (sent, total) => { told.push([sent, total]); }, ended: ending.signal });
    return { answer, ending, told };
  }

  it('tells how far it is and what was answered', async () => {
    const { answer, told } = begin('word');
    expect(FakeRequest.last.sent).toEqual(['PUT', 'http://host/inbox/a.ply', 'Authorization', 'Bearer word', SCAN]);
    FakeRequest.last.upload.dispatchEvent(Object.assign(new Event('progress'), { loaded: 1, total: 4 }));
    FakeRequest.last.answer(409, 'It is there.\n');
    expect(await answer).toEqual({ status: 409, text: 'It is there.' });
    expect(told).toEqual([[1, 4]]);
  });

  it('may break off, or be ended', async () => {
    const broken = begin(null);
    expect(FakeRequest.last.sent).not.toContain('Authorization');
    FakeRequest.last.dispatchEvent(new Event('error'));
    expect(await broken.answer).toEqual({ status: 0, text: '' });
    const ended = begin(null);
    ended.ending.abort();
    expect(await ended.answer).toBeNull();
  });
});

describe('what is dropped', () => {
  type Tree = string | { name: string; children: Tree[] };

  function entry(tree: Tree): object {
    if (typeof tree === 'string') return { isFile: true, name: tree, file: (take: (file: File) => void) => { take(new File([], tree)); } };
    const left = tree.children.map(entry);
    return { isFile: false, name: tree.name, createReader: () => ({ readEntries: (take: (some: object[]) => void) => { take(left.splice(0, 2)); } }) };
  }

  it('is found in folders, however many there are', async () => {
    const trees: Tree[] = ['a.ply', { name: 'house', children: ['1.png', '2.png', { name: 'deep', children: ['3.png'] }, '4.png', 'house.obj'] }];
    const items = trees.map((tree) => ({ webkitGetAsEntry: () => entry(tree) }));
    const found = await droppedFiles({ items, files: [] } as unknown as DataTransfer);
    expect(found.map(({ path }) => path)).toEqual(['a.ply', 'house/1.png', 'house/2.png', 'house/deep/3.png', 'house/4.png', 'house/house.obj']);
  });
});
