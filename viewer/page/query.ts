// SPDX-License-Identifier: MIT
// The page's address says this beside the link to a view: `?models=URL` another listing, `?model=URL` one
// hierarchy without a listing, `&with=URL` another one to compare it with, and `&story=URL` what is told about it. The language, `?lang=`, is chosen by words/words.ts.
import { modelOfPath, resolveUrl, type Model } from './listing.js';
import { words } from './words/words.js';

export interface Query {
  listing: string;
  /// The one model; then there is no listing.
  only: Model | null;
  /// It is compared with this one, `&with=URL`; null: with none.
  other: Model | null;
  /// Why what it says cannot be shown.
  problem: { message: string; more: string } | null;
}

const LISTING = 'models.json';
const MOST_SHOWN = 200; // characters in a message

/// For a message: somebody else may have written it, at any length.
export function shortened(text: string): string {
  return text.length > MOST_SHOWN ? `${text.slice(0, MOST_SHOWN)}…` : text;
}

function badAddress(key: 'model' | 'models' | 'story' | 'with', value: string): Query['problem'] {
  const { badAddress, badModel, badListing } = words.problems;
  return { message: badAddress(`${key === 'story' || key === 'with' ? '&' : '?'}${key}=${shortened(value)}`), more: key === 'model' || key === 'with' ? badModel : badListing };
}

/// `story`: null if the address names none.
function readModel(model: string, story: string | null, base: string): Pick<Query, 'only' | 'problem'> {
  const only = modelOfPath(model, base);
  if (only === null) return { only, problem: badAddress('model', model) };
  only.story = resolveUrl(story ?? '', base);
  return { only, problem: story === null || only.story !== null ? null : badAddress('story', story) };
}

/// `isAlone`: there is a model that the other one may be compared with.
function readOther(given: string | null, isAlone: boolean, base: string): Pick<Query, 'other' | 'problem'> {
  const other = given === null || !isAlone ? null : modelOfPath(given, base);
  const problem = given === null || other !== null ? null : isAlone ? badAddress('with', given) : { message: words.pair.nothingBeside, more: '' };
  return { other, problem };
}

/// `base`: the page's own address. `embedded`: a model that is shown whatever the address says; null: there is none.
export function readQuery(search: string, base: string, embedded: Model | null = null): Query {
  const parameters = new URLSearchParams(search);
  const [model, models] = [parameters.get('model'), parameters.get('models')];
  const listing = new URL(LISTING, base).href;
  const { only, problem } = embedded !== null ? { only: embedded, problem: null } : model === null ? { only: null, problem: null } : readModel(model, parameters.get('story'), base);
  const beside = readOther(parameters.get('with'), only !== null, base);
  if (only !== null || model !== null) return { listing, only, other: beside.other, problem: problem ?? beside.problem };
  const named = models === null ? listing : resolveUrl(models, base);
  return { listing: named ?? listing, only, other: null, problem: named === null ? badAddress('models', models ?? '') : beside.problem };
}
