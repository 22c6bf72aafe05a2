import { gzipSync } from 'node:zlib';
import { describe, expect, it } from 'vitest';
import { OutlineSource } from '../../page/gallery/outline_source.js';
import { outlineBytes } from '../hierarchy/outline_bytes.js';

const LINE = new Uint8Array(outlineBytes({ positions: [0, 0, 0, 1, 0, 0], segments: [0, 1] }));
const LOST = new Response(null, { status: 404 });

function packed(bytes: Uint8Array): Uint8Array<ArrayBuffer> {
  return new Uint8Array(gzipSync(bytes));
}

/// With the answers of its host, one after the other, and what it was asked.
function sourceOf(...answers: Response[]): { source: OutlineSource; asked: string[] } {
  const asked: string[] = [];
  const fetch = (url: string): Promise<Response> => {
    asked.push(url);
    return Promise.resolve(answers[asked.length - 1]);
  };
  return { source: new OutlineSource('http://host/a.hier', fetch), asked };
}

describe('the source of an outline', () => {
  it('gives it once, and asks for it once', async () => {
    const { source, asked } = sourceOf(new Response(LINE));
    const shape = source.ask();
    expect(source.ask()).toBeNull();
    expect([...(await shape)!.ends]).toEqual([0, 0, 0, 1, 0, 0]);
    expect(source.ask()).toBeNull();
    expect(asked).toEqual(['http://host/a.hier/outline.glb']);
  });

  it('takes it out of its gzip', async () => {
    const { source } = sourceOf(new Response(packed(LINE)));
    expect((await source.ask())!.ends).toHaveLength(6);
  });

  it('asks again, once, after a failure', async () => {
    const { source } = sourceOf(LOST, new Response(LINE));
    await expect(source.ask()).rejects.toThrow('outline.glb: the host answered 404');
    expect((await source.ask())!.ends).toHaveLength(6);
  });

  it('gives up after the second failure', async () => {
    const { source } = sourceOf(LOST, LOST);
    await expect(source.ask()).rejects.toThrow('404');
    await expect(source.ask()).rejects.toThrow('404');
    expect(source.ask()).toBeNull();
  });

  it.each([['sent so', new Uint8Array(2 ** 20 + 1)], ['in gzip', packed(new Uint8Array(2 ** 20 + 1))]])(
    'refuses more than a mebibyte, %s',
    async (_, bytes) => {
      const { source } = sourceOf(new Response(bytes));
      await expect(source.ask()).rejects.toThrow('larger than 1048576 bytes');
    },
  );

  it('gives up what is on its way when it is closed', async () => {
    let signal: AbortSignal | null = null;
    const source = new OutlineSource('http://host/a.hier', (_, init) => new Promise((_, reject) => {
      signal = init!.signal!;
      signal.addEventListener('abort', () => { reject(signal!.reason as Error); });
    }));
    const shape = source.ask();
    source.close();
    await expect(shape).rejects.toThrow('abort');
    expect(source.ask()).toBeNull();
  });
});
