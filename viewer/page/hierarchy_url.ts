// SPDX-License-Identifier: MIT
// The URLs of hierarchies, from paths relative to a listing or to the page.
import { isArchiveUrl } from '../src/hierarchy/archive_format.js';
import { withoutLastSlashes } from '../src/hierarchy/bytes.js';

/// Null of what cannot be fetched; of nothing, too, which would be `base` itself.
export function resolveUrl(path: string, base: string): string | null {
  if (path.trim() === '') return null;
  try {
    const url = new URL(path, base);
    return ['http:', 'https:'].includes(url.protocol) ? url.href : null;
  } catch {
    return null;
  }
}

/// Returns the URL of an archive, or of the directory of a hierarchy, without slashes at its end but where it could be taken for an archive.
/// Null of a directory that its files' names cannot follow.
export function resolveHierarchy(path: string, base: string): string | null {
  const url = resolveUrl(path, base);
  if (url === null || isArchiveUrl(url)) return url;
  const directory = withoutLastSlashes(url);
  return /[?#]/.test(url) ? null : isArchiveUrl(directory) ? `${directory}/` : directory;
}
