// SPDX-License-Identifier: MIT
// Tells whether a file is the one that the index tells of.
import { isGzip } from './bytes.js';

/// The index says this of a file.
export interface Seal {
  readonly bytes: number;
  readonly checksum: bigint;
  /// It is stored in gzip: a host may unpack it.
  readonly isPacked: boolean;
}

/// Tells whether bytes with that checksum are the file of the seal; null: nobody can tell, a host has unpacked them.
export function fits(bytes: Uint8Array, sum: bigint, seal: Seal): boolean | null {
  if (seal.isPacked && !isGzip(bytes)) return null;
  return bytes.length === seal.bytes && sum === seal.checksum;
}
