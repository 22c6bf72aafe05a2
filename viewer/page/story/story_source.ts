// SPDX-License-Identifier: MIT
// The story that lies beside a model.
import { FORMATS } from '../../src/hierarchy/formats.js';
import { MOST_STORY_BYTES } from '../../src/tools/note.js';
import { readNotes, type Notebook } from '../../src/tools/notes.js';
import { fetchText } from '../fetched.js';
import { resolveUrl } from '../listing.js';
import { language } from '../words/words.js';

function refuse(what: string): never {
  throw new Error(what);
}

/// `story`: its address, or itself. Throws Error.
export async function loadStory(story: string, signal: AbortSignal): Promise<Notebook> {
  return readNotes(story.startsWith('{') ? story : await fetchText(story, MOST_STORY_BYTES, signal, refuse), [language]);
}

/// A picture within the story itself, or its address from where the story lies; null of what is not shown. `base`: null: nothing is
/// fetched for what is told.
export function pictureOf(address: string | null | undefined, base: string | null): string | null {
  if (!address) return null;
  if (FORMATS.browserPictures.some((type) => address.startsWith(`data:${type};base64,`))) return address;
  return base === null ? null : resolveUrl(address, base);
}
