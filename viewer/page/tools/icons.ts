// SPDX-License-Identifier: MIT
// Strokes of the drawings on the tools' buttons, on a grid of 24.
import type { ToolName } from './bench.js';

export const TOOL_ICONS: Readonly<Record<ToolName | 'go', string>> = {
  pick: 'M12 3v5M12 16v5M3 12h5M16 12h5M12 11.5v1',
  notes: 'M4 4h16v12h-9l-5 4v-4H4zM8 8h8M8 12h5',
  camera: 'M4 7h4l2-2h4l2 2h4v12H4zM12 9.5a3.5 3.5 0 1 0 0 7a3.5 3.5 0 1 0 0-7',
  go: 'M5 12h13M13 7l5 5-5 5',
  clip: 'M4 8l8-4 8 4v8l-8 4-8-4zM2 18L22 6',
  measure: 'M3 16L16 3l5 5L8 21zM7 12l2 2M10 9l3 3M13 6l2 2',
};
