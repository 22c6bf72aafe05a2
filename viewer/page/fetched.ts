// SPDX-License-Identifier: MIT
// Texts of a host, unchanged ones from the browser's cache.
import { drain } from '../src/hierarchy/bytes.js';
import type { Fail } from '../src/json_value.js';

/// `most`: bytes. Calls `refuse` where the host has none; rejects where it cannot be reached, and when the signal aborts.
export async function fetchText(url: string, most: number, signal: AbortSignal, refuse: Fail): Promise<string> {
  const response = await fetch(url, { cache: 'no-cache', signal });
  if (!response.ok) refuse(`${url}: ${`${response.status} ${response.statusText}`.trim()}`);
  return response.body === null ? '' : new TextDecoder().decode(await drain(response.body, most, url));
}
