// SPDX-License-Identifier: MIT
export { HierarchyView } from './scene/hierarchy_view.js';
export type { ViewEvents, ViewOptions } from './scene/view_options.js';
export type { DrawnTile, TileSource } from './scene/surface.js';
export type { Colours, Look, Mode, Settings, Stats } from './scene/settings.js';
export type { ScalarAttribute } from './hierarchy/scalar_values.js';
export { attributeIndex, wholeRange, type AttributeLook } from './scene/attribute_paint.js';
export { labelColour, rampColour, RAMPS, type RampName } from './scene/ramps.js';
export { MOST_STRETCH, UPS, type Standing, type Up } from './scene/standing.js';
export type { Terrain } from './scene/terrain.js';
export type { Manifest } from './hierarchy/manifest.js';
export { HierarchyProblem, HierarchyReplaced } from './hierarchy/problem.js';
export { readOutline, type Outline } from './hierarchy/outline.js';
export { tilePath, type Node } from './hierarchy/tree.js';
