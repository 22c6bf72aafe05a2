// SPDX-License-Identifier: MIT
// Paths and addresses of models as people read them.
import { withoutLastSlashes } from '../src/hierarchy/bytes.js';

/// A part of an address as people read it: `a b` of `a%20b`.
export function readable(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/// The name behind the last slash of a path.
export function lastPart(path: string): string {
  return readable(withoutLastSlashes(path).replace(/^.*\//, ''));
}

/// `models/sub/david%202.hier` to `david 2`.
export function nameOfPath(path: string): string {
  return lastPart(path).replace(/(.)\.[^.]*$/, '$1') || path;
}
