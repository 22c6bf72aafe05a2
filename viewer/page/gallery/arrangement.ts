// SPDX-License-Identifier: MIT
// Chooses what of the listing is shown, in which order and in which groups.
import { withoutLastSlashes } from '../../src/hierarchy/bytes.js';
import type { Job, ListingPart, Model, TagCount } from '../listing.js';
import { readable } from '../path_name.js';
import { locale } from '../words/words.js';
import type { Order } from '../preferences.js';
import type { Wish } from './wish.js';

export interface Group<Item> {
  /// No two groups have the same one.
  key: string;
  /// Empty: it needs no name.
  name: string;
  items: readonly Item[];
}

const collator = new Intl.Collator(locale, { numeric: true, sensitivity: 'base' });

function plain(text: string): string {
  return text.normalize('NFD').replace(/\p{M}/gu, '').toLowerCase();
}

/// As people read it: of `models/a%20b/c.hier` it is `models/a b`.
function folderOf({ path, folder }: Model): string {
  return folder ?? readable(path.slice(0, Math.max(withoutLastSlashes(path).lastIndexOf('/'), 0)));
}

/// Tells whether a text has all the words of a search.
function matches(words: readonly string[], text: string): boolean {
  const plainText = plain(text);
  return words.every((word) => plainText.includes(word));
}

function wordsOf({ search }: Pick<Wish, 'search'>): string[] {
  return plain(search).split(/\s+/).filter((word) => word !== '');
}

/// Numbers that are not known come last.
function descending(a: number | null, b: number | null): number {
  return (b ?? -1) - (a ?? -1);
}

const byName = (a: Model, b: Model): number => collator.compare(a.name, b.name);

const COMPARISONS: Readonly<Record<Order, (a: Model, b: Model) => number>> = {
  folder: byName,
  name: byName,
  newest: (a, b) => descending(a.modified, b.modified) || byName(a, b),
  size: (a, b) => descending(a.bytes, b.bytes) || byName(a, b),
  triangles: (a, b) => descending(a.triangles, b.triangles) || byName(a, b),
};

/// The folders that all paths begin with are not told: `a/b/x` and `a/c` are called `b/x` and `c`.
function withoutCommonStart(folders: readonly string[]): string[] {
  const parts = folders.map((folder) => folder.split('/'));
  const [first] = parts;
  let common = 0;
  while (common < first.length && parts.every((each) => each[common] === first[common])) ++common;
  return parts.map((each) => each.slice(common).join('/'));
}

function grouped(models: readonly Model[]): Group<Model>[] {
  const groups = new Map<string, Model[]>();
  for (const model of models) {
    const folder = folderOf(model);
    const group = groups.get(folder);
    if (group === undefined) groups.set(folder, [model]);
    else group.push(model);
  }
  const folders = [...groups.keys()].sort(collator.compare);
  const names = folders.length === 0 ? [] : withoutCommonStart(folders);
  return folders.map((folder, i) => ({ key: `folder ${folder}`, name: names[i], items: groups.get(folder)! }));
}

export function arrangeModels(models: readonly Model[], wish: Wish): Group<Model>[] {
  const words = wordsOf(wish);
  const isWanted = ({ tags = [] }: Model): boolean => wish.tag === '' || tags.includes(wish.tag);
  const found = models.filter((model) => isWanted(model) && matches(words, `${model.name} ${folderOf(model)} ${(model.tags ?? []).join(' ')}`)).sort(COMPARISONS[wish.order]);
  return wish.order === 'folder' ? grouped(found) : [{ key: 'models', name: '', items: found }];
}

/// Returns groups of slots, as a server tells how many models each has.
export function arrangeSlots<Slot>(slots: readonly Slot[], { groups }: ListingPart): Group<Slot>[] {
  if (groups.length === 0) return [{ key: 'models', name: '', items: slots }];
  const names = withoutCommonStart(groups.map(({ folder }) => folder));
  let end = 0;
  return groups.map(({ folder, count }, i) => ({ key: `folder ${folder}`, name: names[i], items: slots.slice(end, (end += count)) }));
}

/// Counts how many models have each tag: the most frequent ones first.
export function tagsOf(models: readonly Model[]): TagCount[] {
  const counts = new Map<string, number>();
  for (const { tags = [] } of models) for (const tag of tags) counts.set(tag, (counts.get(tag) ?? 0) + 1);
  return [...counts].map(([tag, count]) => ({ tag, count })).sort((a, b) => b.count - a.count || collator.compare(a.tag, b.tag));
}

/// In the order of the listing: that of the builds.
export function findJobs(jobs: readonly Job[], wish: Pick<Wish, 'search'>): Job[] {
  const words = wordsOf(wish);
  return jobs.filter(({ name }) => matches(words, name));
}
