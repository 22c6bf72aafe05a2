// SPDX-License-Identifier: MIT
// The files of a hierarchy at a URL: those of a directory, or those in an archive.
import { isArchiveUrl } from './archive_format.js';
import { fetchRange, fetchStored, unpacked, withoutLastSlashes, type Fetch } from './bytes.js';
import { MANIFEST, MOST_MANIFEST_BYTES } from './manifest_file.js';
import { RemoteArchive } from './remote_archive.js';

/// Where a file in an archive begins: so many bytes behind the start of another one.
export interface Whereabouts {
  readonly anchor: string;
  readonly distance: number;
  /// Of the file.
  readonly bytes: number;
}

/// Names are relative to the hierarchy. Every failure throws HierarchyProblem, or what ends `init.signal`.
export interface RemoteFiles {
  /// A file of at most `most` bytes as it is stored, perhaps in gzip; a host may have unpacked it. `where`: if it is known.
  stored(name: string, most: number, init?: RequestInit, where?: Whereabouts): Promise<Uint8Array<ArrayBuffer>>;
  /// Whether a file will not come: what is there is not all of the hierarchy. If it is not said, all is there.
  lacks?(name: string): boolean;
  /// Bytes [first, end) of a file of `length`; or all of it, where a host knows no ranges.
  part(name: string, [first, end]: [number, number], length: number, signal: AbortSignal): Promise<Uint8Array<ArrayBuffer>>;
  /// The manifest as the host has it now, from no cache.
  manifestNow(signal: AbortSignal): Promise<Uint8Array<ArrayBuffer>>;
  /// Whether a file, or its first `end` bytes, are here already: no host can replace them.
  holds?(name: string, end?: number): boolean;
  /// Files are asked for as those of that build from now on: no cache gives one of another.
  setBuild?(name: string): void;
  /// The host has another build by now: it is asked for nothing more. False: without it there is nothing.
  leaveHost?(): boolean;
}

/// The content of a file of at most `most` bytes, out of its gzip.
export async function whole(files: RemoteFiles, name: string, most: number, init?: RequestInit): Promise<Uint8Array<ArrayBuffer>> {
  return unpacked(await files.stored(name, most, init), most, name);
}

class RemoteDirectory implements RemoteFiles {
  private readonly base: string;
  private query = '';

  constructor(
    url: string,
    private readonly fetch: Fetch,
  ) {
    this.base = `${withoutLastSlashes(url)}/`;
  }

  stored(name: string, most: number, init: RequestInit = {}): Promise<Uint8Array<ArrayBuffer>> {
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
