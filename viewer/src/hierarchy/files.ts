// SPDX-License-Identifier: MIT
// The files of a hierarchy, wherever they lie.
import { unpacked, type Asking } from './bytes.js';

/// Where a file in an archive begins: so many bytes behind the start of another one.
export interface FilePlace {
  readonly anchor: string;
  readonly distance: number;
  /// The length of the file.
  readonly bytes: number;
}

/// Names are relative to the hierarchy. Every failure throws HierarchyProblem, or what ends `init.signal`.
export interface RemoteFiles {
  /// A file of at most `most` bytes as it is stored, perhaps in gzip; a host may have unpacked it. `where`: if it is known.
  stored(name: string, most: number, init?: Asking, where?: FilePlace): Promise<Uint8Array<ArrayBuffer>>;
  /// Tells whether a file will not come: what is there is not all of the hierarchy. If it is not said, all is there.
  lacks?(name: string): boolean;
  /// Bytes [first, end) of a file of `length`, as they are stored; or all of it, where a host knows no ranges.
  part(name: string, [first, end]: [number, number], length: number, signal: AbortSignal): Promise<Uint8Array<ArrayBuffer>>;
  /// The manifest as the host has it now, from no cache.
  manifestNow(signal: AbortSignal): Promise<Uint8Array<ArrayBuffer>>;
  /// Tells whether a file, or its first `end` bytes, are here already: no host can replace them.
  holds?(name: string, end?: number): boolean;
  /// Files are asked for as those of that build from now on: no cache gives one of another.
  setBuild?(name: string): void;
  /// The host has another build by now: it is asked for nothing more. False: without it there is nothing.
  leaveHost?(): boolean;
}

/// The content of a file of at most `most` bytes, out of its gzip.
export async function whole(files: RemoteFiles, name: string, most: number, init?: Asking): Promise<Uint8Array<ArrayBuffer>> {
  return unpacked(await files.stored(name, most, init), most, name);
}
