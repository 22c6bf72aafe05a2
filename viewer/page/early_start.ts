// SPDX-License-Identifier: MIT
// Files of the first picture are asked for before the code that draws it is there: the root tile, or the beginning of an
// archive, which tells where it is; and a worker that decodes it.
import { HEAD_BYTES, isArchiveUrl } from '../src/hierarchy/archive_format.js';
import { withoutLastSlashes } from '../src/hierarchy/bytes.js';
import { rangeHeader } from '../src/hierarchy/ranged_file.js';
import TileWorker from '../src/hierarchy/tile_worker.js?worker';
import { tilePath } from '../src/hierarchy/tree.js';
import { follow } from './signals.js';

const ROOT = tilePath({ level: 0, index: 0 });

export class EarlyStart {
  private readonly url: string | null;
  private readonly ending = new AbortController();
  private first: Promise<Response> | null = null;
  private worker: Worker | null;

  /// `url`: of the hierarchy; null: nothing of it need be fetched.
  constructor(url: string | null) {
    const isArchive = url !== null && isArchiveUrl(url);
    this.url = url === null || isArchive ? url : `${withoutLastSlashes(url)}/${ROOT}`;
    const init: RequestInit = { priority: 'high', signal: this.ending.signal };
    if (isArchive) Object.assign(init, { headers: rangeHeader(0, HEAD_BYTES), cache: 'no-cache' } satisfies RequestInit); // which version it is
    if (this.url !== null) this.first = fetch(this.url, init);
    this.first?.catch(() => undefined); // whoever asks for it is told
    this.worker = new TileWorker();
    this.worker.addEventListener('error', () => { this.worker = null; }); // whoever has it by then is told
  }

  /// As the global one; what is asked for first was asked for already, and ends with the signal of whoever takes it.
  readonly fetch = (url: string, init?: RequestInit): Promise<Response> => {
    const early = url === this.url ? this.first : null;
    if (early === null) return fetch(url, init);
    this.first = null;
    if (init?.signal) follow(this.ending, init.signal);
    return early;
  };

  /// The first one is there already, unless its script could not be had.
  readonly createWorker = (): Worker => {
    const early = this.worker ?? new TileWorker();
    this.worker = null;
    return early;
  };

  /// Ends what nobody took.
  close(): void {
    if (this.first !== null) this.ending.abort();
    this.first = null;
    this.worker?.terminate();
    this.worker = null;
  }
}
