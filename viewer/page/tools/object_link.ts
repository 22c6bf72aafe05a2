// SPDX-License-Identifier: MIT
// What links tell of objects: `object=NAME`, `by=PROPERTY`, and once for each text `hide=` and `only=`.
import type { ObjectChoice } from '../../src/plugins/objects.js';

export interface ObjectLink extends ObjectChoice {
  /// The name of the object that is picked; null: none is.
  readonly picked: string | null;
  /// The property that objects are coloured by; null: none.
  readonly by: string | null;
}

const NAMES = ['object', 'by', 'hide', 'only'];
/// Longer links are cut by what people paste them into.
const LONGEST = 2000;
const MOST_TEXTS = 100;

/// As links have it; null: nothing is picked, and all is drawn. What would make it too long is left out.
export function formatObjectLink({ picked, by, hidden, only }: ObjectLink): string | null {
  const write = (name: string, texts: readonly string[]): string[] => texts.map((text) => `${name}=${encodeURIComponent(text)}`);
  const all = [...write('object', picked === null ? [] : [picked]), ...write('by', by === null ? [] : [by]), ...write('only', only), ...write('hide', hidden)];
  let left = LONGEST;
  const fitting = all.filter((part) => (left -= part.length + 1) >= 0);
  return fitting.length === 0 ? null : fitting.join('&');
}

/// The part of a link's choices that tells of objects; null: none does.
export function objectsOfChoices(choices: string): string | null {
  const parts = choices.split('&').filter((part) => NAMES.some((name) => part.startsWith(`${name}=`)));
  return parts.length === 0 ? null : parts.join('&');
}

export function parseObjectLink(text: string | null): ObjectLink {
  const choices = new URLSearchParams(text ?? '');
  return { picked: choices.get('object'), by: choices.get('by'), hidden: choices.getAll('hide').slice(0, MOST_TEXTS), only: choices.getAll('only').slice(0, MOST_TEXTS) };
}
