// SPDX-License-Identifier: MIT
// The keys of the tools; those of the view are in view/keys.ts.
import type { ToolName } from './bench.js';

export const TOOL_KEYS: Readonly<Record<ToolName, string>> = { pick: 'I', measure: 'M', clip: 'X', notes: 'N', camera: 'K' };
/// In the tools that have use for them.
export const INNER_KEYS = { snap: 'V', bookmark: 'B', spin: 'R', fullScreen: 'E' } as const;

/// Whether `key`, as an event has it, is one of the above.
export function isKey(key: string, name: keyof typeof INNER_KEYS): boolean {
  return key.toUpperCase() === INNER_KEYS[name];
}
