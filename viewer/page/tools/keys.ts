// The keys of the tools; those of the view are in view/keys.ts.
import type { ToolName } from './bench.js';

export const TOOL_KEYS: Readonly<Record<ToolName, string>> = { pick: 'I', measure: 'M', clip: 'X' };
