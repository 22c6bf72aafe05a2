// SPDX-License-Identifier: MIT
// The tools of the bar, in its order: a row for each; what they are called is in words/. Their code comes when they are first used.
import type { Tool } from './tool.js';
import type { Workshop } from './workshop.js';

interface ToolRow {
  readonly key: string;
  /// Strokes of the drawing on its button, on a grid of 24.
  readonly icon: string;
  readonly load: () => Promise<{ makeTool: (shop: Workshop) => Tool }>;
}

export const TOOLS = {
  pick: { key: 'I', icon: 'M12 3v5M12 16v5M3 12h5M16 12h5M12 11.5v1', load: () => import('./pick_tool.js') },
  measure: { key: 'M', icon: 'M3 16L16 3l5 5L8 21zM7 12l2 2M10 9l3 3M13 6l2 2', load: () => import('./measure_tool.js') },
  clip: { key: 'X', icon: 'M4 8l8-4 8 4v8l-8 4-8-4zM2 18L22 6', load: () => import('./clip_tool.js') },
  notes: { key: 'N', icon: 'M4 4h16v12h-9l-5 4v-4H4zM8 8h8M8 12h5', load: () => import('./notes_tool.js') },
  camera: { key: 'K', icon: 'M4 7h4l2-2h4l2 2h4v12H4zM12 9.5a3.5 3.5 0 1 0 0 7a3.5 3.5 0 1 0 0-7', load: () => import('./camera_tool.js') },
} as const satisfies Record<string, ToolRow>;

export type ToolName = keyof typeof TOOLS;
export const TOOL_NAMES = Object.keys(TOOLS) as readonly ToolName[];
