// What the page's address says beside the link to a view: `?models=URL` another listing, `?model=URL` one
// hierarchy without a listing. The language, `?lang=`, is chosen by words/words.ts.
import { modelOfPath, resolveUrl, type Model } from './listing.js';
import { words } from './words/words.js';

export interface Query {
  listing: string;
  /// The one model; then there is no listing.
  only: Model | null;
  /// Why what it says cannot be shown.
  problem: string | null;
}

const LISTING = 'models.json';
const MOST_SHOWN = 200; // characters in a message

/// For a message: somebody else may have written it, at any length.
export function shortened(text: string): string {
  return text.length > MOST_SHOWN ? `${text.slice(0, MOST_SHOWN)}…` : text;
}

/// `base`: the page's own address.
export function readQuery(search: string, base: string): Query {
  const parameters = new URLSearchParams(search);
  const [model, models] = [parameters.get('model'), parameters.get('models')];
  const listing = new URL(LISTING, base).href;
  if (model !== null) {
    const only = modelOfPath(model, base);
    return { listing, only, problem: only === null ? words.problems.badModel(shortened(model)) : null };
  }
  const other = models === null ? listing : resolveUrl(models, base);
  return { listing: other ?? listing, only: null, problem: other === null ? words.problems.badListing(shortened(models ?? '')) : null };
}
