// SPDX-License-Identifier: MIT
// The story that lies beside a model.
import { MOST_STORY_BYTES } from '../../src/tools/note.js';
import { readNotes, type Notebook } from '../../src/tools/notes.js';
import { fetchText } from '../fetched.js';
import { resolveUrl } from '../listing.js';

function refuse(what: string): never {
  throw new Error(what);
}

/// `story`: its address, or itself. Throws Error.
export async function loadStory(story: string, signal: AbortSignal): Promise<Notebook> {
  return readNotes(story.startsWith('{') ? story : await fetchText(story, MOST_STORY_BYTES, signal, refuse));
}

/// What a note names, from where the story lies; null of what is not shown. Pictures may be in the story itself.
export function resolved(address: string | null | undefined, base: string, isPicture: boolean): string | null {
  if (!address) return null;
  if (isPicture && /^data:image\/(png|jpeg|webp|gif|avif);base64,/.test(address)) return address;
  return resolveUrl(address, base);
}
