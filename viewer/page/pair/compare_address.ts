// SPDX-License-Identifier: MIT
// The page's address with a model, and another one to compare it with.
import { formatAddress, type Spot } from '../address.js';
import { parameterOf } from '../share/embed_code.js';

export interface Compared extends Spot {
  /// The hierarchy's address; null: the page has it within it.
  readonly url: string | null;
  /// That of the other one; null: there is none.
  readonly other: string | null;
  /// The address of what is told about the model.
  readonly story: string | null;
}

/// `here`: the page's own address, of which the language stays.
export function compareAddress(here: string, { url, other, story, pose, choices }: Compared): string {
  const { origin, pathname, searchParams } = new URL(here);
  const page = (origin === 'null' ? 'file://' : origin) + pathname;
  const language = searchParams.get('lang');
  const parts = Object.entries({ model: url, with: other, story }).filter((part): part is [string, string] => part[1] !== null).map(([name, value]) => `${name}=${parameterOf(value, page)}`);
  if (language !== null) parts.push(`lang=${encodeURIComponent(language)}`);
  const hash = pose === null && choices === '' ? '' : formatAddress({ path: '', pose, choices });
  return `${page}${parts.length > 0 ? '?' : ''}${parts.join('&')}${hash}`;
}
