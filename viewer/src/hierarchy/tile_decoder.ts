// Tiles out of their files, in workers if there are any, else where it is called.
import { readTile, type Tile } from './tile.js';

interface Answer {
  id: number;
  tile?: Tile;
  problem?: string;
  milliseconds?: number;
}

interface Waiting {
  resolve: (tile: Tile) => void;
  reject: (problem: Error) => void;
}

export class TileDecoder {
  /// Time spent in decoding, all workers together.
  milliseconds = 0;
  private readonly workers: Worker[] = [];
  private readonly waiting = new Map<number, Waiting>();
  private next = 0;

  constructor(createWorker: (() => Worker) | undefined, count: number) {
    if (createWorker === undefined) return;
    for (let i = 0; i < count; ++i) this.workers.push(this.listen(createWorker()));
  }

  /// Takes `bytes` over: they are gone afterwards.
  async decode(bytes: Uint8Array, name: string): Promise<Tile> {
    if (this.workers.length === 0) {
      const began = performance.now();
      const tile = await readTile(bytes, name);
      this.milliseconds += performance.now() - began;
      return tile;
    }
    const id = this.next++;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      this.workers[id % this.workers.length].postMessage({ id, bytes, name }, [bytes.buffer]);
    });
  }

  dispose(): void {
    for (const worker of this.workers) worker.terminate();
    for (const { reject } of this.waiting.values()) reject(new Error('the view was closed'));
    this.waiting.clear();
  }

  private listen(worker: Worker): Worker {
    worker.addEventListener('message', (event: MessageEvent<Answer>) => {
      this.settle(event.data);
    });
    worker.addEventListener('error', (event) => {
      const problem = new Error(`a decoder stopped: ${event.message}`);
      for (const { reject } of this.waiting.values()) reject(problem);
      this.waiting.clear();
    });
    return worker;
  }

  private settle({ id, tile, problem, milliseconds }: Answer): void {
    const waiting = this.waiting.get(id);
    this.waiting.delete(id);
    this.milliseconds += milliseconds ?? 0;
    if (tile) waiting?.resolve(tile);
    else waiting?.reject(new Error(problem));
  }
}
