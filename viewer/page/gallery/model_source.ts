// What a cell shows of a model, fetched when it is asked for.
import type { Fetch } from '../../src/hierarchy/bytes.js';
import { fetchManifest } from '../../src/hierarchy/manifest.js';
import { fetchOutline } from '../../src/hierarchy/outline.js';
import { shapeOf, type Shape } from './shape.js';

const MOST_TRIES = 2;

export interface Facts {
  readonly vertices: number | null;
  readonly triangles: number | null;
  /// Of all files of the hierarchy.
  readonly bytes: number | null;
  /// Its picture's address, if it has one.
  readonly preview: string | null;
}

export class ModelSource {
  private readonly ending = new AbortController();
  private tries = MOST_TRIES; // that are left
  private waits = false;

  /// `url`: of the hierarchy.
  constructor(
    private readonly url: string,
    private readonly fetch: Fetch = (url, init) => globalThis.fetch(url, init),
  ) {}

  /// Null: it is on its way or was given already, or failed too often. Rejects with an Error that names the file.
  outline(): Promise<Shape> | null {
    if (this.waits || this.tries === 0 || this.ended) return null;
    --this.tries;
    this.waits = true;
    return this.readOutline();
  }

  /// From the manifest. Rejects with an Error that names the file.
  async facts(): Promise<Facts> {
    const { source, totalBytes, preview } = await fetchManifest(this.fetch, `${this.url}/`, this.ending.signal);
    return { vertices: source.vertices, triangles: source.triangles, bytes: totalBytes, preview: preview === null ? null : `${this.url}/${preview}` };
  }

  get ended(): boolean {
    return this.ending.signal.aborted;
  }

  /// What is on its way is given up.
  close(): void {
    this.ending.abort();
  }

  private async readOutline(): Promise<Shape> {
    try {
      const shape = shapeOf(await fetchOutline(this.fetch, `${this.url}/`, this.ending.signal));
      this.tries = 0;
      return shape;
    } finally {
      this.waits = false;
    }
  }
}
