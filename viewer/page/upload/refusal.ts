// SPDX-License-Identifier: MIT
// Says why the server did not take an upload.
import { words } from '../words/words.js';
import type { Answer } from './send.js';

export function refusalText(name: string, { status, text }: Answer): string {
  const { upload } = words;
  if (status === 0) return upload.lost(name);
  if (status === 409) return upload.taken(name);
  if (status === 507) return upload.noRoom(name);
  return upload.refused(name, text === '' ? String(status) : text);
}
