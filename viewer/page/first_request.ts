// SPDX-License-Identifier: MIT
// What a page asks a hierarchy's host for first: the root tile, or the beginning of an archive, which tells where it is.
import { HEAD_BYTES, isArchiveUrl } from '../src/hierarchy/archive_format.js';
import { withoutLastSlashes } from '../src/hierarchy/bytes.js';
import { rangeHeader } from '../src/hierarchy/ranged_file.js';
import { tilePath } from '../src/hierarchy/tree.js';

/// It was sent, and is whoever's who asks for the same.
export interface FirstRequest {
  readonly url: string;
  readonly response: Promise<Response>;
  /// Ends it.
  readonly ending: AbortController;
}

/// `url`: of the hierarchy. `after`: what is more urgent on a slow line.
export function sendFirstRequest(url: string, after?: Promise<void>): FirstRequest {
  const ending = new AbortController();
  const isArchive = isArchiveUrl(url);
  const file = isArchive ? url : `${withoutLastSlashes(url)}/${tilePath({ level: 0, index: 0 })}`;
  const init: RequestInit = { priority: 'high', signal: ending.signal };
  if (isArchive) Object.assign(init, { headers: rangeHeader(0, HEAD_BYTES), cache: 'no-cache' } satisfies RequestInit); // which version it is
  const send = (): Promise<Response> => fetch(file, init);
  const response = after === undefined ? send() : after.then(send);
  response.catch(() => undefined); // whoever asks for it is told
  return { url: file, response, ending };
}
