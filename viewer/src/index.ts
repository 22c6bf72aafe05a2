// SPDX-License-Identifier: MIT
export { HierarchyView, type Plugin, type Stage } from './scene/hierarchy_view.js';
export type { Frame } from './plugins/plugin.js';
export { replaceChunk, type Shader, type Shading } from './scene/shading.js';
export type { Omission, Omits } from './scene/omission.js';
export { CameraPose, type Pose } from './scene/camera_pose.js';
export type { ViewEvents, ViewOptions } from './scene/view_options.js';
export type { DrawnTile, TileSource } from './scene/surface.js';
export { attributeIndex, wholeRange, type AttributeLook, type Colours, type Look, type Mode, type Settings, type Stats } from './scene/settings.js';
export { isLabel, type ScalarAttribute } from './hierarchy/scalar_values.js';
export type { ObjectTable } from './hierarchy/object_table.js';
export type { ObjectRow, ObjectValue } from './hierarchy/object_blocks.js';
export { labelColour, rampColour, RAMPS, type RampName } from './scene/ramps.js';
export { MOST_STRETCH, UPS, type Standing, type Up } from './scene/standing.js';
export type { Terrain } from './scene/terrain.js';
export type { Manifest } from './hierarchy/manifest.js';
export { HierarchyProblem, HierarchyReplaced } from './hierarchy/problem.js';
export { readOutline, type Outline } from './hierarchy/outline.js';
export { tilePath, type Node } from './hierarchy/tree.js';
