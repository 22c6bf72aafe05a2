// SPDX-License-Identifier: MIT
// The word that a server asks for before it takes meshes, as long as the tab.

const KEY = 'meshhier-upload-token';

/// Null: it is not known, or the browser keeps nothing.
export function storedToken(): string | null {
  try {
    return sessionStorage.getItem(KEY);
  } catch {
    return null;
  }
}

/// Null: it is forgotten.
export function storeToken(token: string | null): void {
  try {
    if (token === null) sessionStorage.removeItem(KEY);
    else sessionStorage.setItem(KEY, token);
  } catch {
    // it is known until the page is left
  }
}
