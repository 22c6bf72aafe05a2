// SPDX-License-Identifier: MIT
// What a visitor looks for, as a server is asked for it.
import type { Order } from '../preferences.js';

export interface Wish {
  /// Words that a name, folder or tag must have, in any order; empty: all.
  search: string;
  /// A tag that a model must have; empty: any.
  tag: string;
  order: Order;
}

/// Models that are asked for at once: a window or two.
export const PART = 120;

/// Returns the address of a part of a listing. Hosts that know no parts give all of it.
/// An address that asks for something already stays as it is: it may be signed.
export function partAddress(listing: string, { search, tag, order }: Wish, more: Readonly<Record<string, string>> = {}): string {
  if (/[?#]/.test(listing)) return listing;
  const query = new URLSearchParams({ count: String(PART), order, ...(search !== '' && { search }), ...(tag !== '' && { tag }), ...more });
  return `${listing}?${query}`;
}
