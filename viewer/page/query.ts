// SPDX-License-Identifier: MIT
// The page's address says this beside the link to a view: `?models=URL` another listing, `?model=URL` one
// hierarchy without a listing, and `&story=URL` what is told about it. The language, `?lang=`, is chosen by words/words.ts.
import { modelOfPath, resolveUrl, type Model } from './listing.js';
import { words } from './words/words.js';

export interface Query {
  listing: string;
  /// The one model; then there is no listing.
  only: Model | null;
  /// Why what it says cannot be shown.
  problem: { message: string; more: string } | null;
}

const LISTING = 'models.json';
const MOST_SHOWN = 200; // characters in a message

/// For a message: somebody else may have written it, at any length.
export function shortened(text: string): string {
  return text.length > MOST_SHOWN ? `${text.slice(0, MOST_SHOWN)}…` : text;
}

function badAddress(key: 'model' | 'models' | 'story', value: string): Query['problem'] {
  const { badAddress, badModel, badListing } = words.problems;
  return { message: badAddress(`${key === 'story' ? '&' : '?'}${key}=${shortened(value)}`), more: key === 'model' ? badModel : badListing };
}

/// `story`: null if the address names none.
function readModel(model: string, story: string | null, base: string): Omit<Query, 'listing'> {
  const only = modelOfPath(model, base);
  if (only === null) return { only, problem: badAddress('model', model) };
  only.story = resolveUrl(story ?? '', base);
  return { only, problem: story === null || only.story !== null ? null : badAddress('story', story) };
}

/// `base`: the page's own address.
export function readQuery(search: string, base: string): Query {
  const parameters = new URLSearchParams(search);
  const [model, models] = [parameters.get('model'), parameters.get('models')];
  const listing = new URL(LISTING, base).href;
  if (model !== null) return { listing, ...readModel(model, parameters.get('story'), base) };
  const other = models === null ? listing : resolveUrl(models, base);
  return { listing: other ?? listing, only: null, problem: other === null ? badAddress('models', models ?? '') : null };
}
