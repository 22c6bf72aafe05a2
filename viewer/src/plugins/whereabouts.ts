// SPDX-License-Identifier: MIT
// Tells when a view shows another build whose places are others: then nothing that was measured holds.
import type { Manifest } from '../hierarchy/manifest.js';

/// Tells whether places in the tiles of one are the same places in those of the other.
function isSamePlace(one: Manifest, other: Manifest): boolean {
  const placeOf = ({ origin, place, up, transform, units }: Manifest): string => JSON.stringify([origin, place, up, transform, units]);
  return placeOf(one) === placeOf(other);
}

export class Whereabouts {
  private known: Manifest | null = null;

  /// Since last asked, or taken as they are. `manifest`: null: it is not known where they are.
  haveChanged(manifest: Manifest | null): boolean {
    const { known } = this;
    this.known = manifest ?? known;
    return known !== null && manifest !== null && known !== manifest && !isSamePlace(known, manifest);
  }
}
