export { HierarchyView, type ViewEvents, type ViewOptions } from './scene/hierarchy_view.js';
export type { DrawnTile, TileSource } from './scene/surface.js';
export type { Colours, Look, Mode, Settings, Stats } from './scene/settings.js';
export type { Manifest } from './hierarchy/manifest.js';
export { HierarchyProblem } from './hierarchy/problem.js';
export { readOutline, type Outline } from './hierarchy/outline.js';
export { tilePath, type Node } from './hierarchy/tree.js';
