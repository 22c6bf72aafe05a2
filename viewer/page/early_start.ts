// SPDX-License-Identifier: MIT
// Files of the first picture are asked for before the code that draws it is there: what a hierarchy's host is asked for first, which the
// page's boot has done already where it could, and a worker that decodes it.
import TileWorker from '../src/hierarchy/tile_worker.js?worker';
import { takeBooted } from './booted.js';
import { sendFirstRequest, type FirstRequest } from './first_request.js';
import type { Poster } from './poster.js';
import { follow } from './signals.js';

export class EarlyStart {
  /// Stands in the model's place; null: nothing does.
  readonly poster: Poster | null;
  private first: FirstRequest | null;
  private worker: Worker | null;

  /// `url`: of the hierarchy; null: nothing of it need be fetched.
  constructor(url: string | null) {
    const booted = takeBooted(url);
    this.poster = booted?.poster ?? null;
    this.first = booted?.first ?? (url === null ? null : sendFirstRequest(url));
    this.worker = new TileWorker();
    this.worker.addEventListener('error', () => { this.worker = null; }); // whoever has it by then is told
  }

  /// As the global one; what is asked for first was asked for already, and ends with the signal of whoever takes it.
  readonly fetch = (url: string, init?: RequestInit): Promise<Response> => {
    const { first } = this;
    if (first === null || url !== first.url) return fetch(url, init);
    this.first = null;
    if (init?.signal) follow(first.ending, init.signal);
    return first.response;
  };

  /// The first one is there already, unless its script could not be had.
  readonly createWorker = (): Worker => {
    const early = this.worker ?? new TileWorker();
    this.worker = null;
    return early;
  };

  /// Ends what nobody took.
  close(): void {
    this.first?.ending.abort();
    this.first = null;
    this.worker?.terminate();
    this.worker = null;
  }
}
