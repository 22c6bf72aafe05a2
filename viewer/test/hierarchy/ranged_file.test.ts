// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { RangedFile } from '../../src/hierarchy/ranged_file.js';
import { RangedHost } from '../support/ranged_host.js';

const FILE = new Uint8Array(1000);

function told(host: RangedHost, range: string): void {
  host.next = (right) => {
    const headers = new Headers(right.headers);
    headers.set('Content-Range', range);
    return new Response(right.body, { status: 206, headers });
  };
}

describe('a length that a host tells', () => {
  it.each(['9223372036854775808', '18446744073709551616', '9007199254740992', '9'.repeat(400)])('of %s bytes is no file\'s', async (total) => {
    const host = new RangedHost(FILE);
    told(host, `bytes 0-99/${total}`);
    await expect(new RangedFile('https://host/a.3tz', 'a.3tz', host.fetch).readUpTo(0, 100)).rejects.toThrow(/bytes, as no file has/);
    told(host, `bytes 10-19/${total}`);
    await expect(new RangedFile('https://host/a.3tz', 'a.3tz', host.fetch).read(10, 20)).rejects.toThrow(/bytes, as no file has/);
  });

  it('is refused for HEAD, too', async () => {
    const host = new RangedHost(FILE, { hidesHeaders: true });
    const file = new RangedFile('https://host/a.3tz', 'a.3tz', host.fetch);
    await file.readUpTo(0, 100);
    host.next = () => new Response(null, { headers: { 'Content-Length': '9223372036854775808' } });
    await expect(file.size()).rejects.toThrow(/bytes, as no file has/);
  });

  it('may be that of the largest disk', async () => {
    const host = new RangedHost(FILE);
    told(host, 'bytes 0-99/1125899906842624');
    const file = new RangedFile('https://host/a.3tz', 'a.3tz', host.fetch);
    expect(await file.readUpTo(0, 100)).toHaveLength(100);
    expect(await file.size()).toBe(2 ** 50);
  });
});
