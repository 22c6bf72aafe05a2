// SPDX-License-Identifier: MIT
// models.json: what there is to show, and what is being made. Whatever it holds, what comes out of
// here is as the types say.
import type { RemoteFiles } from '../src/hierarchy/files.js';
import type { Json } from '../src/json_value.js';
import { resolveHierarchy, resolveUrl } from './hierarchy_url.js';
import { lastPart, nameOfPath } from './path_name.js';
import { words } from './words/words.js';

export { resolveUrl };

export interface Model {
  name: string;
  /// The hierarchy's, relative to the listing.
  path: string;
  url: string;
  vertices: number | null;
  triangles: number | null;
  bytes: number | null;
  source: string | null;
  /// When it was made, in seconds since 1970.
  modified: number | null;
  /// Its picture's address.
  preview: string | null;
  /// The address of what people tell about it (src/tools/annotations.ts), or itself: JSON.
  story: string | null;
  /// The folder that people see it in, instead of its path's; missing: not told.
  folder?: string;
  tags?: readonly string[];
  /// Longitude and latitude, degrees.
  place?: readonly [longitude: number, latitude: number];
  /// Warnings of its build; missing: there are none, or they are not told.
  warnings?: readonly string[];
  /// Where its files are, if not at its URL.
  files?: RemoteFiles;
}

export interface Job {
  name: string;
  state: 'waiting' | 'building' | 'failed';
  stage: string;
  /// 0 … 1, if it is known.
  progress: number | null;
  secondsLeft: number | null;
  message: string;
  /// The address of a picture of what is there so far.
  preview: string | null;
}

/// A listing is a part of a longer one, in an order and of a search that were asked for.
export interface ListingPart {
  /// All models of the whole listing; `found` counts those that the search finds.
  readonly total: number;
  readonly found: number;
  /// The number of the first model, of those that are found.
  readonly first: number;
  /// The whole listing's name: parts that name it fit together.
  readonly state: string;
  /// How many of those that are found lie in each folder, in order; empty: they are in another order.
  readonly groups: readonly { readonly folder: string; readonly count: number }[];
  readonly tags: readonly TagCount[];
  /// So many of those that are found have a place.
  readonly placed: number;
  /// Where they lie, if that was asked for.
  readonly places: readonly ModelSpot[];
}

export interface TagCount {
  readonly tag: string;
  readonly count: number;
}

/// Longitude, latitude, and the number of the model that lies there.
export type ModelSpot = readonly [longitude: number, latitude: number, index: number];

export interface Listing {
  models: Model[];
  /// Null: it has all models that there are, but for those of `parts`.
  part: ListingPart | null;
  /// The addresses of listings that go on.
  parts: readonly string[];
  /// Null: the listing has none and never will.
  jobs: Job[] | null;
  /// Where the models lie, and where meshes are put; null: it does not say so.
  folder: string | null;
  inbox: string | null;
  /// Null: the server takes no meshes.
  upload: UploadOffer | null;
}

export interface UploadOffer {
  /// The most bytes of one upload.
  limit: number;
  /// The server asks for a word.
  token: boolean;
  /// It keeps first views of models, for the same people.
  views: boolean;
}

export class ListingError extends Error {}

const MOST_ENTRIES = 10_000; // of one file
const MOST_FOUND = 1_000_000; // models, of which a window holds a few
const MOST_TEXT = 1000;
const MOST_WARNINGS = 100; // of a model
const MOST_TAGS = 100;
const MOST_PARTS = 1000;

function isObject(value: unknown): value is Json {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

function textOf(value: unknown): string {
  return typeof value === 'string' ? value.slice(0, MOST_TEXT) : '';
}

function textsOf(value: unknown): string[] {
  return Array.isArray(value) ? value.slice(0, MOST_WARNINGS).map(textOf).filter((text) => text !== '') : [];
}

function countOf(value: unknown): number | null {
  return typeof value === 'number' && Number.isFinite(value) && value >= 0 ? value : null;
}

/// Returns the file name of its hierarchy: `dragon.hier`.
export function fileOf({ name, path, files }: Model): string {
  return files === undefined ? lastPart(path) : `${name}.hier`;
}

/// A model of which nothing but the path is known. Null if it cannot be fetched, or is longer than a path may be.
export function modelOfPath(path: string, base: string): Model | null {
  const url = path.length > MOST_TEXT ? null : resolveHierarchy(path, base);
  if (url === null) return null;
  return { name: nameOfPath(path), path, url, vertices: null, triangles: null, bytes: null, source: null, modified: null, preview: null, story: null };
}

/// The address of what belongs to a model. Null of what is none, or cannot be fetched.
function addressOf(value: unknown, base: string): string | null {
  return resolveUrl(textOf(value), base);
}

function placeOf(value: unknown): [number, number] | null {
  if (!Array.isArray(value) || value.length < 2 || !value.slice(0, 2).every(Number.isFinite)) return null;
  const [longitude, latitude] = value as number[];
  return Math.abs(longitude) <= 180 && Math.abs(latitude) <= 90 ? [longitude, latitude] : null;
}

/// What people say of a model.
function readDescription(value: Json): Partial<Model> {
  const [folder, tags, place] = [textOf(value.folder), textsOf(value.tags), placeOf(value.place)];
  return { ...(folder !== '' && { folder }), ...(tags.length > 0 && { tags }), ...(place !== null && { place }) };
}

function readModel(value: unknown, base: string): Model | null {
  if (!isObject(value) || typeof value.path !== 'string') return null;
  const model = modelOfPath(value.path, base);
  if (model === null) return null;
  model.name = textOf(value.title).trim() || textOf(value.name).trim() || model.name;
  Object.assign(model, readDescription(value));
  model.vertices = countOf(value.vertices);
  model.triangles = countOf(value.triangles);
  model.bytes = countOf(value.bytes);
  model.source = textOf(value.source) || null;
  model.modified = countOf(value.modified);
  model.preview = addressOf(value.preview, base);
  model.story = addressOf(value.story, base);
  const warnings = textsOf(value.warnings);
  if (warnings.length > 0) model.warnings = warnings;
  return model;
}

function readJob(value: unknown, base: string): Job | null {
  if (!isObject(value)) return null;
  const { state } = value;
  if (state !== 'waiting' && state !== 'building' && state !== 'failed') return null;
  const progress = countOf(value.progress);
  return {
    name: textOf(value.name) || words.listing.namelessMesh,
    state,
    stage: textOf(value.stage),
    progress: progress === null ? null : Math.min(progress, 1),
    secondsLeft: countOf(value.seconds_left),
    message: textOf(value.message),
    preview: addressOf(value.preview, base),
  };
}

function readUpload(value: unknown): UploadOffer | null {
  if (!isObject(value)) return null;
  const limit = countOf(value.limit);
  return limit === null ? null : { limit, token: value.token === true, views: value.views === true };
}

/// Returns a whole number from 0 on.
function wholeOf(value: unknown): number {
  return Math.floor(countOf(value) ?? 0);
}

function itemsOf(value: unknown, most = MOST_ENTRIES): unknown[] {
  return Array.isArray(value) ? value.slice(0, most) : [];
}

function readPart(document: Json): ListingPart | null {
  const { state } = document;
  const [total, found] = [countOf(document.total), countOf(document.found)];
  if (typeof state !== 'string' || total === null || found === null || found > MOST_FOUND) return null;
  const counted = (values: unknown, key: string, most: number): [string, number][] =>
    itemsOf(values, most).filter(isObject).map((each) => [textOf(each[key]), wholeOf(each.count)]);
  return {
    total, found: wholeOf(found), first: wholeOf(document.first), state: textOf(state), placed: wholeOf(document.placed),
    groups: counted(document.groups, 'folder', MOST_FOUND).map(([folder, count]) => ({ folder, count })),
    tags: counted(document.tags, 'tag', MOST_TAGS).map(([tag, count]) => ({ tag, count })),
    places: itemsOf(document.places, MOST_FOUND).flatMap((spot) => {
      const place = placeOf(spot);
      return place === null ? [] : [[...place, wholeOf((spot as unknown[])[2])] as const];
    }),
  };
}

/// Returns what `read` makes of the entries, without what it refuses; of several with one key the first.
function readAll<T>(values: unknown[], read: (value: unknown) => T | null, key: (item: T) => string): T[] {
  const found = new Map<string, T>();
  for (const value of values.slice(0, MOST_ENTRIES)) {
    const item = read(value);
    if (item !== null && !found.has(key(item))) found.set(key(item), item);
  }
  return [...found.values()];
}

/// As visitors see it who only look: how models were made is nothing for them.
export function withoutWarnings(listing: Listing): Listing {
  const models = listing.models.map((model) => ({ ...model }));
  for (const model of models) delete model.warnings;
  return { ...listing, models };
}

/// The listing that was fetched from `url`, to which all its addresses are relative; parts of it are elsewhere. Entries that are not as they should be are left out.
/// Throws ListingError if all of it is something else.
export function parseListing(text: string, url: string): Listing {
  let document: unknown;
  try {
    document = JSON.parse(text);
  } catch {
    throw new ListingError(words.listing.notJson(url));
  }
  if (!isObject(document) || !Array.isArray(document.models)) throw new ListingError(words.listing.noModels(url));
  const models = readAll(document.models, (value) => readModel(value, url), (model) => model.path);
  const jobs = Array.isArray(document.jobs) ? readAll(document.jobs, (value) => readJob(value, url), (job) => job.name) : null;
  const parts = itemsOf(document.parts, MOST_PARTS).map((part) => addressOf(part, url)).filter((part) => part !== null);
  return { models, part: readPart(document), parts, jobs, folder: textOf(document.folder) || null, inbox: textOf(document.inbox) || null, upload: readUpload(document.upload) };
}
