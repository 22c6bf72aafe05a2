// SPDX-License-Identifier: MIT
// Who may put meshes to where a listing is from, as far as the page can tell; the server decides for itself.
import type { UploadOffer } from '../listing.js';
import { storedToken } from './stored_token.js';

function isLoopback(host: string): boolean {
  return host === 'localhost' || host === '[::1]' || /^127(\.\d+){3}$/.test(host);
}

/// `offer`: of the listing at `url`. Where nothing is taken over the network, whoever is at the machine puts files into its folder.
export function maySend(offer: UploadOffer | null, url: string, page: Pick<Location, 'origin' | 'hostname'> = location): boolean {
  if (new URL(url).origin !== page.origin) return false;
  return offer === null ? isLoopback(page.hostname) : !offer.token || storedToken() !== null;
}
