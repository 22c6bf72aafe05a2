// SPDX-License-Identifier: MIT
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { gzipSync } from 'node:zlib';
import { afterAll, afterEach, describe, expect, it, vi } from 'vitest';
import { checksum, digitsOf } from '../src/hierarchy/checksum.js';
import { ProgressiveMesh, StreamError, type StreamIndex } from '../src/progressive/index.js';
import { parseStreamIndex } from '../src/progressive/stream_index.js';
import { fetchFrom, hasProgram, MESHHIER, Workshop } from './support/meshhier.js';

const MEBIBYTE = 2 ** 20;
const NAME = 'base.bin';

/// The three lists of the base, each of one run at the most.
function baseOf(...lists: [count: number, content: Uint8Array][]): Uint8Array<ArrayBuffer> {
  const parts: Uint8Array[] = [Buffer.from('MHDETAIL'), new Uint8Array(new Uint32Array([1, 0]).buffer)];
  lists.forEach(([count, content], at) => {
    if (count === 0) return;
    const packed = gzipSync(content);
    parts.push(new Uint8Array(new Uint32Array([at + 1, count, packed.length]).buffer), packed);
  });
  return new Uint8Array(Buffer.concat(parts));
}

/// Three vertices at the origin: indices that follow one another, residuals of 0.
const VERTICES = new Uint8Array(3 + 3 * 12);
const TRIANGLE = new Uint8Array([0, 0, 2, 2]);
const BASE = baseOf([3, VERTICES], [1, TRIANGLE]);

/// The index of a stream of one triangle, with a change.
function indexText(change: object = {}, file: object = {}): string {
  const base = { file: NAME, level: 0, vertices: 3, triangles: 1, merges: 0, shown_vertices: 3, shown_triangles: 1, bytes: BASE.length, checksum: digitsOf(checksum(BASE)) };
  return JSON.stringify({
    format: 'meshhier-progressive', format_version: 2, vertices: 3, own_vertices: 3, triangles: 1, origin: [0, 0, 0], up: 'y', licence: '',
    source: {
      file_name: 'a.ply',
      attributes: { normals: false, colours: 'none', alpha: false, texcoords: false },
      bounds: { min: [0, 0, 0], max: [0, 0, 0] },
    },
    files: [{ ...base, ...file }],
    ...change,
  });
}

function indexOf(change: object = {}, file: object = {}): StreamIndex {
  return parseStreamIndex(indexText(change, file), 'progressive.json');
}

function take(bytes: Uint8Array<ArrayBuffer>): Promise<unknown> {
  return new ProgressiveMesh(indexOf({}, { bytes: bytes.length, checksum: digitsOf(checksum(bytes)) })).take(bytes, NAME);
}

/// A host with these files; the others are lost.
function host(files: Record<string, BodyInit>): void {
  vi.stubGlobal('fetch', (url: string) => Promise.resolve(url in files ? new Response(files[url]) : new Response(null, { status: 404 })));
}

/// 64 mebibytes, and how many of them were asked for.
function flood(): { body: ReadableStream<Uint8Array>; sent: () => number } {
  let sent = 0;
  const body = new ReadableStream<Uint8Array>({
    pull(to) {
      to.enqueue(new Uint8Array(MEBIBYTE));
      if (++sent === 64) to.close();
    },
  });
  return { body, sent: () => sent };
}

afterEach(() => { vi.unstubAllGlobals(); });

describe('a progressive stream', () => {
  it('refuses a file of another stream', async () => {
    const mesh = new ProgressiveMesh(indexOf({}, { checksum: '0123456789abcdef' }));
    await expect(mesh.take(BASE, NAME)).rejects.toThrow('base.bin: is damaged, or of another stream');
  });

  it('puts its base into its arrays', async () => {
    host({ 'a/progressive.json': indexText(), 'a/base.bin': BASE });
    const mesh = await ProgressiveMesh.open('a');
    expect(await mesh.next('a')).toMatchObject({ file: NAME, entries: 4, bytes: BASE.length });
    expect([...mesh.triangles]).toEqual([0, 1, 2]);
    expect([...mesh.values]).toEqual(new Array(9).fill(0));
    expect(await mesh.next('a')).toBeNull();
  });

  it('refuses a run that unpacks to more than its entries take', async () => {
    const [vertices, triangle] = [new Uint8Array(64 * MEBIBYTE), new Uint8Array(64 * MEBIBYTE)];
    await expect(take(baseOf([3, vertices]))).rejects.toThrow(new StreamError(`${NAME}: a run is damaged`));
    await expect(take(baseOf([0, triangle], [1, triangle]))).rejects.toThrow(new StreamError(`${NAME}: a run is damaged`));
  });

  it('refuses a run with bytes left', async () => {
    await expect(take(baseOf([3, new Uint8Array(VERTICES.length + 1)]))).rejects.toThrow(new StreamError(`${NAME}: bytes are left in a run`));
  });

  it.each([
    ['vertices', { vertices: 2 ** 32 - 1 }, {}],
    ['triangles', { triangles: 2 ** 32 - 1 }, {}],
    ['bytes', {}, { bytes: 2 ** 40 }],
  ])('refuses an index with too many %s', (key, change, file) => {
    expect(() => indexOf(change, file)).toThrow(StreamError);
    expect(() => indexOf(change, file)).toThrow(`${key}" is not from`);
  });

  it('counts with all values of a vertex', () => {
    const attributes = { normals: true, colours: 'u8', alpha: true, texcoords: true };
    const source = { file_name: 'a.ply', attributes, bounds: { min: [0, 0, 0], max: [0, 0, 0] } };
    expect(indexOf({ vertices: 1e8 }).vertices).toBe(1e8);
    expect(() => indexOf({ vertices: 1e8, source })).toThrow(StreamError);
  });

  it.each([{ vertices: 2 ** 40 }, { triangles: 2 ** 40 }])('tells where there is no memory: %o', (counts) => {
    expect(() => new ProgressiveMesh({ ...indexOf(), ...counts })).toThrow(new StreamError('a.ply: there is no memory for it'));
  });

  it('reads no more of an index than it may have', async () => {
    const { body, sent } = flood();
    host({ 'a/progressive.json': body });
    await expect(ProgressiveMesh.open('a')).rejects.toThrow(new StreamError('a/progressive.json: larger than 1048576 bytes'));
    expect(sent()).toBeLessThan(5);
  });

  it('reads no more of a file than the index tells of', async () => {
    const { body, sent } = flood();
    host({ 'a/base.bin': body });
    const mesh = new ProgressiveMesh(indexOf());
    await expect(mesh.next('a')).rejects.toThrow(new StreamError(`a/base.bin: larger than ${BASE.length} bytes`));
    expect(sent()).toBeLessThan(5);
  });

  it('names what cannot be had', async () => {
    host({});
    await expect(ProgressiveMesh.open('a')).rejects.toThrow(new StreamError('a/progressive.json: the host answered 404'));
    vi.stubGlobal('fetch', () => Promise.reject(new TypeError('refused')));
    await expect(ProgressiveMesh.open('a')).rejects.toThrow(StreamError);
    await expect(ProgressiveMesh.open('a')).rejects.toThrow('a/progressive.json');
  });
});

describe.runIf(hasProgram)('a stream that the program makes', () => {
  const workshop = new Workshop();
  afterAll(() => { workshop.remove(); });

  it('ends as the original mesh', async () => {
    const hierarchy = workshop.build('ring', ['surface', '--shape', 'torus', '--triangles', '8000'],
      { simplify: { method: 'half_edge' }, partition: { vertices: 500 } });
    const stream = path.join(workshop.directory, 'ring.prog');
    execFileSync(MESHHIER, ['progressive', hierarchy, '-o', stream, '--progress', 'none']);
    vi.stubGlobal('fetch', fetchFrom(stream));
    const mesh = await ProgressiveMesh.open('.');
    while (await mesh.next('.'));
    expect(mesh.taken).toBeGreaterThan(2);
    const { index, triangles, values } = mesh;
    const { files } = JSON.parse(readFileSync(path.join(stream, 'progressive.json'), 'utf8')) as StreamIndex;
    expect(index.files.map(({ bytes }) => bytes)).toEqual(files.map(({ bytes }) => bytes));
    expect(values.some(Number.isNaN)).toBe(false);
    expect(triangles.every((corner) => corner < index.vertices)).toBe(true);
    for (let i = 0; i < triangles.length; i += 3) expect(triangles[i]).not.toBe(triangles[i + 1]);
  });
});
