// SPDX-License-Identifier: MIT
// What links tell of objects: `object=NAME`, `by=PROPERTY` with `between=FROM,TO`, and once for each text `only=`, `hide=` and `show=`.
import type { ObjectChoice } from '../../src/tools/object_choice.js';

export interface ObjectLink extends ObjectChoice {
  /// The name of the object that is picked; null: none is.
  readonly picked: string | null;
  /// The property that objects are coloured by; null: none.
  readonly by: string | null;
  /// Where its colours begin and end; null: at the least and the greatest number.
  readonly between: readonly [number, number] | null;
}

const NAMES = ['object', 'by', 'between', 'hide', 'only', 'show'];
/// Longer links are cut by what people paste them into.
const LONGEST = 2000;
const MOST_TEXTS = 100;

/// As links have it; null: nothing is picked, and all is drawn. What would make it too long is left out.
export function formatObjectLink({ picked, by, between, hidden, only, shown }: ObjectLink): string | null {
  const write = (name: string, texts: readonly string[]): string[] => texts.map((text) => `${name}=${encodeURIComponent(text)}`);
  const one = (name: string, text: string | null): string[] => (text === null ? [] : write(name, [text]));
  const all = [...one('object', picked), ...one('by', by), ...one('between', between?.join(',') ?? null), ...write('only', only), ...write('hide', hidden), ...write('show', shown)];
  let left = LONGEST;
  const fitting = all.filter((part) => (left -= part.length + 1) >= 0);
  return fitting.length === 0 ? null : fitting.join('&');
}

/// The part of a link's choices that tells of objects; null: none does.
export function objectsOfChoices(choices: string): string | null {
  const parts = choices.split('&').filter((part) => NAMES.some((name) => part.startsWith(`${name}=`)));
  return parts.length === 0 ? null : parts.join('&');
}

function parseBetween(text: string | null): readonly [number, number] | null {
  const numbers = text?.split(',').map((part) => (part.trim() === '' ? NaN : Number(part))) ?? [];
  return numbers.length === 2 && numbers.every(Number.isFinite) ? [numbers[0], numbers[1]] : null;
}

export function parseObjectLink(text: string | null): ObjectLink {
  const choices = new URLSearchParams(text ?? '');
  const all = (name: string): string[] => choices.getAll(name).slice(0, MOST_TEXTS);
  return { picked: choices.get('object'), by: choices.get('by'), between: parseBetween(choices.get('between')), hidden: all('hide'), only: all('only'), shown: all('show') };
}
