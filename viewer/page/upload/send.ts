// SPDX-License-Identifier: MIT
// Sends an upload to the server. XMLHttpRequest tells how much has gone; fetch does not.
import { words } from '../words/words.js';
import type { Upload } from './plan.js';

export interface ServerAnswer {
  /// 0: there was none.
  status: number;
  /// The server said so, in one line.
  text: string;
}

export interface Sending {
  /// The address of the inbox, with a slash at its end.
  inbox: string;
  token: string | null;
  /// Bytes of the request that have gone; all of `total` before the answer comes.
  told: (sent: number, total: number) => void;
  ended: AbortSignal;
}

export function requestOf({ name, files, isFolder }: Upload): { method: string; path: string; body: Blob | FormData } {
  const path = encodeURIComponent(name);
  if (!isFolder) return { method: 'PUT', path, body: files[0].file };
  const body = new FormData();
  for (const { name: each, file } of files) body.append('file', file, each);
  return { method: 'POST', path, body };
}

/// Sends an upload. Resolves to null if it was ended.
export function send(upload: Upload, { inbox, token, told, ended }: Sending): Promise<ServerAnswer | null> {
  const { method, path, body } = requestOf(upload);
  return new Promise((resolve) => {
    const request = new XMLHttpRequest();
    request.open(method, inbox + path);
    if (token !== null) request.setRequestHeader('Authorization', `Bearer ${token}`);
    request.upload.addEventListener('progress', ({ loaded, total }) => { told(loaded, total); });
    request.addEventListener('load', () => { resolve({ status: request.status, text: request.responseText.trim() }); });
    request.addEventListener('error', () => { resolve({ status: 0, text: '' }); });
    request.addEventListener('abort', () => { resolve(null); });
    ended.addEventListener('abort', () => { request.abort(); });
    if (ended.aborted) resolve(null);
    else request.send(body);
  });
}

/// Says why the server did not take an upload.
export function refusalText(name: string, { status, text }: ServerAnswer): string {
  const { upload } = words;
  if (status === 0) return upload.lost(name);
  if (status === 409) return upload.taken(name);
  if (status === 507) return upload.noRoom(name);
  return upload.refused(name, text === '' ? String(status) : text);
}
