// SPDX-License-Identifier: MIT
// The files of a hierarchy at a URL: those of a directory, or those in an archive.
import { isArchiveUrl } from './archive_format.js';
import { fetchRange, fetchStored, unpacked, withoutLastSlashes, type Asking, type Fetch } from './bytes.js';
import type { RemoteFiles } from './files.js';
import { MANIFEST, MOST_MANIFEST_BYTES } from './manifest_file.js';
import { RemoteArchive } from './remote_archive.js';

class RemoteDirectory implements RemoteFiles {
  private readonly base: string;
  private query = '';

  constructor(
    url: string,
    private readonly fetch: Fetch,
  ) {
    this.base = `${withoutLastSlashes(url)}/`;
  }

  stored(name: string, most: number, init: Asking = {}): Promise<Uint8Array<ArrayBuffer>> {
    return fetchStored(this.fetch, this.base + name + this.query, name, most, init);
  }

  part(name: string, range: [number, number], length: number, signal: AbortSignal): Promise<Uint8Array<ArrayBuffer>> {
    return fetchRange(this.fetch, this.base + name + this.query, name, range, length, signal);
  }

  async manifestNow(signal: AbortSignal): Promise<Uint8Array<ArrayBuffer>> {
    const stored = await fetchStored(this.fetch, this.base + MANIFEST, MANIFEST, MOST_MANIFEST_BYTES, { signal, cache: 'no-cache' });
    return unpacked(stored, MOST_MANIFEST_BYTES, MANIFEST);
  }

  setBuild(name: string): void {
    this.query = `?build=${name}`;
  }
}

/// `url`: of a directory, or of an archive.
export function remoteFiles(url: string, fetch: Fetch): RemoteFiles {
  return isArchiveUrl(url) ? new RemoteArchive(url, fetch) : new RemoteDirectory(url, fetch);
}
