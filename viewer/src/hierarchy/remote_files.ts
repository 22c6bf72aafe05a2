// SPDX-License-Identifier: MIT
// The files of a hierarchy at a URL: those of a directory, or those in an archive.
import { isArchiveUrl } from './archive_format.js';
import { fetchBytes, fetchRange, withoutLastSlashes, type Fetch } from './bytes.js';
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
  /// The content of a file of at most `most` bytes, out of its gzip. `where`: if it is known.
  whole(name: string, most: number, init?: RequestInit, where?: Whereabouts): Promise<Uint8Array<ArrayBuffer>>;
  /// Whether a file will not come: what is there is not all of the hierarchy. If it is not said, all is there.
  lacks?(name: string): boolean;
  /// Bytes [first, end) of a file of `length`; or all of it, where a host knows no ranges.
  part(name: string, [first, end]: [number, number], length: number, signal: AbortSignal): Promise<Uint8Array<ArrayBuffer>>;
}

class RemoteDirectory implements RemoteFiles {
  private readonly base: string;

  constructor(
    url: string,
    private readonly fetch: Fetch,
  ) {
    this.base = `${withoutLastSlashes(url)}/`;
  }

  whole(name: string, most: number, init: RequestInit = {}): Promise<Uint8Array<ArrayBuffer>> {
    return fetchBytes(this.fetch, this.base + name, name, most, init);
  }

  part(name: string, range: [number, number], length: number, signal: AbortSignal): Promise<Uint8Array<ArrayBuffer>> {
    return fetchRange(this.fetch, this.base + name, name, range, length, signal);
  }
}

/// `url`: of a directory, or of an archive.
export function remoteFiles(url: string, fetch: Fetch): RemoteFiles {
  return isArchiveUrl(url) ? new RemoteArchive(url, fetch) : new RemoteDirectory(url, fetch);
}
