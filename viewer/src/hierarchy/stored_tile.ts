// SPDX-License-Identifier: MIT
// A tile out of its file as it is stored, if it is the file that the index tells of.
import { unpacked } from './bytes.js';
import { checksum } from './checksum.js';
import { HierarchyProblem } from './problem.js';
import { fits, type Seal } from './seal.js';
import { readTile, type Tile } from './tile.js';
import type { ExpectedCounts } from './tile_counts.js';

export interface TileWanted {
  readonly name: string;
  /// Bytes of the content, out of its gzip.
  readonly most: number;
  /// Null: nobody knows.
  readonly expected: ExpectedCounts | null;
  /// Null: not known, or of no matter.
  readonly seal: Seal | null;
  /// The normal map has not come yet: zeros stand in its place, and the tile is read without it.
  readonly isBeginning?: boolean;
}

export interface OpenedTile {
  readonly tile: Tile;
  /// They are those that the seal is of. False: a host has unpacked them, or there was no seal.
  readonly isSealed: boolean;
}

/// Unpacks, compares and decodes a tile. Throws HierarchyProblem of `wanted.name`.
export async function openTile(bytes: Uint8Array<ArrayBuffer>, { name, most, expected, seal, isBeginning = false }: TileWanted): Promise<OpenedTile> {
  const isFitting = seal && fits(bytes, checksum(bytes), seal);
  if (isFitting === false) throw new HierarchyProblem(name, 'its size or checksum is not that of the index: it is damaged, or of another build');
  return { tile: await readTile(await unpacked(bytes, most, name), name, expected, isBeginning), isSealed: isFitting ?? false };
}
