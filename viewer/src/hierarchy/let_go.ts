// SPDX-License-Identifier: MIT
// Lets go of tiles. Stands beside tile.ts because a page that decodes tiles in workers has no use for the rest of that.
import { dropPicture } from './picture.js';
import type { Tile } from './tile.js';

/// Frees the pictures of a tile that nothing draws any longer: collectors of garbage know little of their size.
export function letGo({ picture, normalMap }: Tile): void {
  if (picture) dropPicture(picture);
  if (normalMap) dropPicture(normalMap);
}
