// SPDX-License-Identifier: MIT
// Fetches what a cell shows of a model, when it is asked for.
import { isArchiveUrl } from '../../src/hierarchy/archive_format.js';
import { withoutLastSlashes, type Fetch } from '../../src/hierarchy/bytes.js';
import { fetchManifest, type NamedFile } from '../../src/hierarchy/manifest.js';
import { fetchOutline } from '../../src/hierarchy/outline.js';
import { whole, type RemoteFiles } from '../../src/hierarchy/files.js';
import { remoteFiles } from '../../src/hierarchy/remote_files.js';
import { shapeOf, type Shape } from './shape.js';

const MOST_TRIES = 2;

export interface Facts {
  readonly vertices: number | null;
  readonly triangles: number | null;
  /// The bytes of all files of the hierarchy.
  readonly bytes: number | null;
  /// Its picture's address, if it has one.
  readonly preview: string | null;
}

export class ModelSource {
  private readonly ending = new AbortController();
  private readonly files: RemoteFiles;
  private picture: string | null = null; // made of an archive's
  private tries = MOST_TRIES; // that are left
  private waits = false;

  /// `url`: of the hierarchy.
  constructor(
    private readonly url: string,
    fetch: Fetch = (url, init) => globalThis.fetch(url, init),
  ) {
    this.files = remoteFiles(url, fetch);
  }

  /// Null: it is on its way or was given already, or failed too often. Rejects with an Error that names the file.
  outline(): Promise<Shape> | null {
    if (this.waits || this.tries === 0 || this.ended) return null;
    --this.tries;
    this.waits = true;
    return this.readOutline();
  }

  /// From the manifest. Rejects with an Error that names the file.
  async facts(): Promise<Facts> {
    const { source, totalBytes, preview } = await fetchManifest(this.files, this.ending.signal);
    const picture = preview === null ? null : await this.pictureOf(preview);
    return { vertices: source.vertices, triangles: source.triangles, bytes: totalBytes, preview: picture };
  }

  /// Its address: that of a file in an archive is the page's own.
  private async pictureOf({ file, bytes }: NamedFile): Promise<string> {
    if (!isArchiveUrl(this.url)) return `${withoutLastSlashes(this.url)}/${file}`;
    const content = await whole(this.files, file, bytes, { signal: this.ending.signal });
    this.ending.signal.throwIfAborted();
    this.picture ??= URL.createObjectURL(new Blob([content], { type: 'image/webp' }));
    return this.picture;
  }

  get ended(): boolean {
    return this.ending.signal.aborted;
  }

  /// Gives up what is on its way.
  close(): void {
    this.ending.abort();
    if (this.picture !== null) URL.revokeObjectURL(this.picture);
  }

  private async readOutline(): Promise<Shape> {
    try {
      const shape = shapeOf(await fetchOutline(this.files, this.ending.signal));
      this.tries = 0;
      return shape;
    } finally {
      this.waits = false;
    }
  }
}
