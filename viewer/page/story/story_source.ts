// SPDX-License-Identifier: MIT
// The story that lies beside a model.
import { drain } from '../../src/hierarchy/bytes.js';
import { readNotes, type Notebook } from '../../src/tools/notes.js';

const MOST_BYTES = 2 ** 24;

async function fetchText(url: string, signal: AbortSignal): Promise<string> {
  const response = await fetch(url, { cache: 'no-cache', signal });
  if (!response.ok) throw new Error(`${url}: ${`${response.status} ${response.statusText}`.trim()}`);
  return response.body === null ? '' : new TextDecoder().decode(await drain(response.body, MOST_BYTES, url));
}

/// `story`: its address, or itself. Throws Error.
export async function loadStory(story: string, signal: AbortSignal): Promise<Notebook> {
  return readNotes(story.startsWith('{') ? story : await fetchText(story, signal));
}

/// What a note names, from where the story lies; null of what is not shown. Pictures may be in the story itself.
export function resolved(address: string | null | undefined, base: string, isPicture: boolean): string | null {
  if (!address) return null;
  if (isPicture && /^data:image\/(png|jpeg|webp|gif|avif);base64,/.test(address)) return address;
  try {
    const url = new URL(address, base);
    return ['http:', 'https:'].includes(url.protocol) ? url.href : null;
  } catch {
    return null;
  }
}
