// What the first picture needs is asked for before the code that draws it is there: the root tile, and a worker
// that decodes it.
import TileWorker from '../src/hierarchy/tile_worker.js?worker';
import { tilePath } from '../src/hierarchy/tree.js';
import { follow } from './signals.js';

const ROOT = tilePath({ level: 0, index: 0 });

export class EarlyStart {
  private readonly url: string;
  private readonly ending = new AbortController();
  private root: Promise<Response> | null;
  private worker: Worker | null;

  /// `url`: of the hierarchy.
  constructor(url: string) {
    this.url = `${url}/${ROOT}`;
    this.root = fetch(this.url, { priority: 'high', signal: this.ending.signal });
    this.root.catch(() => undefined); // whoever asks for it is told
    this.worker = new TileWorker();
    this.worker.addEventListener('error', () => { this.worker = null; }); // whoever has it by then is told
  }

  /// As the global one; the root was asked for already, and ends with the signal of whoever takes it.
  readonly fetch = (url: string, init?: RequestInit): Promise<Response> => {
    const early = url === this.url ? this.root : null;
    if (early === null) return fetch(url, init);
    this.root = null;
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
    if (this.root !== null) this.ending.abort();
    this.root = null;
    this.worker?.terminate();
    this.worker = null;
  }
}
