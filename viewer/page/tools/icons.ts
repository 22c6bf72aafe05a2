// Strokes of the drawings on the tools' buttons, on a grid of 24.
import type { ToolName } from './bench.js';

export const TOOL_ICONS: Readonly<Record<ToolName, string>> = {
  pick: 'M12 3v5M12 16v5M3 12h5M16 12h5M12 11.5v1',
  clip: 'M4 8l8-4 8 4v8l-8 4-8-4zM2 18L22 6',
  measure: 'M3 16L16 3l5 5L8 21zM7 12l2 2M10 9l3 3M13 6l2 2',
};
