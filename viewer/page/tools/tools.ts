// SPDX-License-Identifier: MIT
// The tools of the bar, in its order: a row for each; what they are called is in words/. Their code comes when they are first used.
import type { Manifest } from '../../src/index.js';
import type { ViewPart } from '../../src/view/view_table.js';
import type { Tool } from './tool.js';
import type { Workshop } from './workshop.js';

interface ToolRow {
  readonly key: string;
  /// The part of views that is its own: links, and what is told, have it; null: none.
  readonly part: ViewPart | null;
  /// Strokes of the drawing on its button, on a grid of 24.
  readonly icon: string;
  /// A link that tells of it does not open its card: the picture says all.
  readonly isQuiet?: true;
  /// Only some models have use for it.
  readonly applies?: (manifest: Manifest) => boolean;
  readonly load: () => Promise<{ makeTool: (shop: Workshop) => Tool }>;
}

export const TOOLS = {
  pick: { key: 'I', part: 'pick', icon: 'M12 3v5M12 16v5M3 12h5M16 12h5M12 11.5v1', load: () => import('./pick_tool.js') },
  objects: { key: 'J', part: 'objects', icon: 'M3 21V10l6-4v15M9 21V3l12 5v13zM13 10v1M17 11v1M13 15v1M17 15v1', applies: ({ objects }) => objects !== null, load: () => import('./objects_tool.js') },
  measure: { key: 'M', part: 'measure', icon: 'M3 16L16 3l5 5L8 21zM7 12l2 2M10 9l3 3M13 6l2 2', load: () => import('./measure_tool.js') },
  clip: { key: 'X', part: 'cut', isQuiet: true, icon: 'M4 8l8-4 8 4v8l-8 4-8-4zM2 18L22 6', load: () => import('./clip_tool.js') },
  plan: { key: 'D', part: null, icon: 'M4 3h16v18H4zM4 10h7M11 3v4M11 10v4M15 21v-7h5', load: () => import('./plan_tool.js') },
  rooms: { key: 'Y', part: 'rooms', icon: 'M3 11l9-7 9 7M5 9.5V20h14V9.5M9 20v-7h6v7M14 16.5v.1', load: () => import('./rooms_tool.js') },
  notes: { key: 'N', part: 'notes', icon: 'M4 4h16v12h-9l-5 4v-4H4zM8 8h8M8 12h5', load: () => import('./notes_tool.js') },
  camera: { key: 'K', part: null, icon: 'M4 7h4l2-2h4l2 2h4v12H4zM12 9.5a3.5 3.5 0 1 0 0 7a3.5 3.5 0 1 0 0-7', load: () => import('./camera_tool.js') },
} as const satisfies Record<string, ToolRow>;

export type ToolName = keyof typeof TOOLS;

/// Tells whether a model has use for a tool.
export function applies(name: ToolName, manifest: Manifest): boolean {
  const row: ToolRow = TOOLS[name];
  return row.applies?.(manifest) ?? true;
}

/// Tells whether a link that tells of it opens its card.
export function opensByLink(name: ToolName): boolean {
  const row: ToolRow = TOOLS[name];
  return row.isQuiet !== true;
}

export const TOOL_NAMES = Object.keys(TOOLS) as readonly ToolName[];
