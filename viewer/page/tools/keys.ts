// SPDX-License-Identifier: MIT
// Keys within tools that have use for them; those that open a tool are in tools.ts, those of the view in view/keys.ts.

export const INNER_KEYS = { snap: 'V', bookmark: 'B', spin: 'R', fullScreen: 'E' } as const;

/// Tells whether `key`, as an event has it, is one of the above.
export function isKey(key: string, name: keyof typeof INNER_KEYS): boolean {
  return key.toUpperCase() === INNER_KEYS[name];
}
