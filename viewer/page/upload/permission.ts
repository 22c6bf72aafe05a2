// SPDX-License-Identifier: MIT
// Who may put meshes to where a listing is from, as far as the page can tell; the server decides for itself. The word that
// it may ask for is kept as long as the tab.
import type { UploadOffer } from '../listing.js';

const KEY = 'meshhier-upload-token';

/// Null: it is not known, or the browser keeps nothing.
export function storedToken(): string | null {
  try {
    return sessionStorage.getItem(KEY);
  } catch {
    return null;
  }
}

/// Keeps the word; null: forgets it.
export function storeToken(token: string | null): void {
  try {
    if (token === null) sessionStorage.removeItem(KEY);
    else sessionStorage.setItem(KEY, token);
  } catch {
    // it is known until the page is left
  }
}

function isLoopback(host: string): boolean {
  return host === 'localhost' || host === '[::1]' || /^127(\.\d+){3}$/.test(host);
}

/// The same, where the visitor can be asked for the word.
export function mayAsk(offer: UploadOffer, url: string, page: Pick<Location, 'origin' | 'hostname'> = location): boolean {
  return maySend({ ...offer, token: false }, url, page);
}

/// `offer`: of the listing at `url`. Where nothing is taken over the network, whoever is at the machine puts files into its folder.
export function maySend(offer: UploadOffer | null, url: string, page: Pick<Location, 'origin' | 'hostname'> = location): boolean {
  if (new URL(url).origin !== page.origin) return false;
  return offer === null ? isLoopback(page.hostname) : !offer.token || storedToken() !== null;
}
