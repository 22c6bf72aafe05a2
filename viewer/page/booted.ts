// SPDX-License-Identifier: MIT
// Passes on what the page's boot has begun, to the page.
import type { FirstRequest } from './first_request.js';
import type { Poster } from './poster.js';

export interface Booted {
  /// The hierarchy's.
  readonly url: string;
  readonly first: FirstRequest;
  /// Null: there is none to show.
  readonly poster: Poster | null;
}

declare global {
  var meshhierBooted: Booted | undefined;
}

/// Once; null: nothing was begun for that hierarchy, and what was begun for another one ends. `url`: null: none is opened.
export function takeBooted(url: string | null): Booted | null {
  const booted = globalThis.meshhierBooted;
  globalThis.meshhierBooted = undefined;
  if (booted === undefined || booted.url === url) return booted ?? null;
  booted.first.ending.abort();
  booted.poster?.end();
  return null;
}
