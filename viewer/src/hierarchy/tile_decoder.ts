// SPDX-License-Identifier: MIT
// Tiles out of their files, in workers if there are any, else where it is called.
import { transcoderUrl } from './basis.js';
import { NOT_DECODED } from './picture.js';
import { HierarchyProblem } from './problem.js';
import type { OpenedTile, TileWanted } from './stored_tile.js';

interface Answer {
  id: number;
  opened?: OpenedTile;
  /// Says what is wrong with the file.
  what?: string;
  /// Says what went wrong otherwise.
  defect?: string;
  milliseconds?: number;
}

interface WaitingTile {
  readonly worker: Worker;
  readonly bytes: Uint8Array<ArrayBuffer>;
  readonly wanted: TileWanted;
  readonly resolve: (opened: OpenedTile) => void;
  readonly reject: (problem: Error) => void;
}

export class TileDecoder {
  /// Time spent in decoding, all workers together.
  milliseconds = 0;
  private readonly workers: Worker[] = [];
  private readonly tasks = new Map<number, WaitingTile>();
  private next = 0;
  private isOver = false;

  constructor(createWorker: (() => Worker) | undefined, count: number) {
    if (createWorker === undefined) return;
    for (let i = 0; i < count; ++i) this.workers.push(this.listen(createWorker()));
  }

  /// `bytes`: as they are stored. Throws HierarchyProblem.
  async decode(bytes: Uint8Array<ArrayBuffer>, wanted: TileWanted): Promise<OpenedTile> {
    if (this.isOver) throw new Error('the view was closed');
    if (this.workers.length === 0) return this.decodeHere(bytes, wanted);
    const id = this.next++;
    const worker = this.workers[id % this.workers.length];
    return new Promise((resolve, reject) => {
      this.tasks.set(id, { worker, bytes, wanted, resolve, reject });
      worker.postMessage({ id, bytes, wanted, transcoder: transcoderUrl() });
    });
  }

  dispose(): void {
    this.isOver = true;
    for (const worker of this.workers) worker.terminate();
    for (const { reject } of this.tasks.values()) reject(new Error('the view was closed'));
    this.tasks.clear();
  }

  /// The code for it comes when it is first wanted: where workers are, it seldom is.
  private async decodeHere(bytes: Uint8Array<ArrayBuffer>, wanted: TileWanted): Promise<OpenedTile> {
    const { openTile } = await import('./stored_tile.js');
    const began = performance.now();
    const opened = await openTile(bytes, wanted);
    this.milliseconds += performance.now() - began;
    return opened;
  }

  private listen(worker: Worker): Worker {
    worker.addEventListener('message', (event: MessageEvent<Answer>) => {
      this.settle(event.data);
    });
    for (const failure of ['error', 'messageerror'])
      worker.addEventListener(failure, () => {
        this.doWithout(worker);
      });
    return worker;
  }

  /// A worker that did not come up, or broke down: what it had to do is done here.
  private doWithout(broken: Worker): void {
    const at = this.workers.indexOf(broken);
    if (at >= 0) this.workers.splice(at, 1);
    broken.terminate();
    for (const [id, { worker, bytes, wanted, resolve, reject }] of this.tasks) {
      if (worker !== broken) continue;
      this.tasks.delete(id);
      this.decodeHere(bytes, wanted).then(resolve, reject);
    }
  }

  private settle({ id, opened, what, defect, milliseconds }: Answer): void {
    const task = this.tasks.get(id);
    this.tasks.delete(id);
    this.milliseconds += milliseconds ?? 0;
    if (opened) task?.resolve(opened);
    // WebKit: workers of a page that was opened from a disk cannot decode pictures, the page can.
    else if (task && what === NOT_DECODED) this.decodeHere(task.bytes, task.wanted).then(task.resolve, task.reject);
    else task?.reject(what === undefined ? new Error(defect) : new HierarchyProblem(task.wanted.name, what));
  }
}
