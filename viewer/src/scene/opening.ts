// SPDX-License-Identifier: MIT
// One opening of a hierarchy: what all tiles need, however often the host or the line fails.
import type { Manifest } from '../hierarchy/manifest.js';
import type { RemoteFiles } from '../hierarchy/files.js';
import { HierarchyProblem } from '../hierarchy/problem.js';
import { RemoteHierarchy, type Directory } from '../hierarchy/remote_hierarchy.js';
import type { Tile } from '../hierarchy/tile.js';
import type { TileDecoder } from '../hierarchy/tile_decoder.js';

const RETRY_MS = 1000; // twice as long each time
const LONGEST_RETRY_MS = 30_000;
/// After so many times there is no root.
const MOST_TRIES = 5;

export interface OpenRoot {
  readonly root: Tile;
  /// The manifest, which was asked for already.
  readonly early: Promise<Manifest>;
  /// Once there is a picture of the root: nothing but the root is fetched of the mesh before.
  readonly drawn?: Promise<void>;
}

/// Whoever loads a hierarchy is told of its files.
export interface FileHost {
  /// A file failed; of what is tried again, each failure but the last.
  tell(file: string, problem: unknown): void;
  /// A file has come.
  recover(file: string): void;
}

export class Opening {
  readonly remote: RemoteHierarchy;
  private readonly ending = new AbortController();
  private wake: (() => void) | null = null;

  /// `isAnew`: after another build: no cache is asked for what has the same address in both.
  constructor(
    files: RemoteFiles,
    decoder: TileDecoder,
    private readonly host: FileHost,
    readonly isAnew: boolean,
  ) {
    this.remote = new RemoteHierarchy(files, decoder, this.ending.signal, isAnew);
  }

  get isClosed(): boolean {
    return this.ending.signal.aborted;
  }

  /// `early`: as RemoteHierarchy.root() has it, with each try.
  async root(early?: (root: Tile) => void): Promise<Tile> {
    return this.persist('root', MOST_TRIES, () => this.remote.root(early));
  }

  /// Tries until it is there, unless what failed will not pass. `onPage`: more of the index has come.
  async directory({ root, early, drawn }: OpenRoot, onPage: () => void): Promise<Directory> {
    const onIndex = (): void => {
      if (!this.isClosed) this.host.recover('index');
      onPage();
    };
    return this.persist('directory', Infinity, async (tries) => {
      const manifest = await (tries === 1 ? early : this.remote.manifest());
      return this.remote.directory(manifest, root, onIndex, (problem) => { if (!this.isClosed) this.host.tell('index', problem); }, drawn);
    });
  }

  /// Asks at once for what failed.
  hurry(): void {
    this.wake?.();
  }

  /// Ends all that is under way.
  close(reason = new Error('the view was closed')): void {
    this.ending.abort(reason);
    this.wake?.();
  }

  /// Tries again what failed by the host or the line.
  private async persist<T>(file: string, most: number, ask: (tries: number) => Promise<T>): Promise<T> {
    for (let tries = 1; ; ++tries) {
      try {
        const found = await ask(tries);
        this.ending.signal.throwIfAborted();
        this.host.recover(file);
        return found;
      } catch (problem) {
        const mayPass = problem instanceof HierarchyProblem && problem.mayPass;
        if (tries === most || !mayPass || this.isClosed) throw problem;
        this.host.tell(file, problem);
      }
      await this.pause(Math.min(RETRY_MS * 2 ** (tries - 1), LONGEST_RETRY_MS));
      this.ending.signal.throwIfAborted();
    }
  }

  private async pause(milliseconds: number): Promise<void> {
    await new Promise<void>((resolve) => {
      const timer = setTimeout(resolve, milliseconds);
      this.wake = () => {
        clearTimeout(timer);
        resolve();
      };
    });
    this.wake = null;
  }
}
