// SPDX-License-Identifier: MIT
// Objects that are left out: one table says which, for all shaders that draw tiles and for what tools measure.
import type { DataTexture } from 'three';
import type { ObjectRange } from '../hierarchy/object_table.js';
import type { Tile } from '../hierarchy/tile.js';
import type { Omission } from '../scene/omission.js';
import { replaceChunk, type Shader } from '../scene/shading.js';
import { texelBytes, texelOf, texelTexture } from './object_texels.js';

const OUT = 255;

/// A triangle whose corners are all at one place, outside of what is seen, is none; so is an edge, and a point.
const LEFT_OUT = `#include <project_vertex>
if (leavesObjectsOut && ${texelOf('leftOutObjects', 'object')}.r > 0.5) gl_Position = vec4(0.0, 0.0, 2.0, 1.0);`;

/// Objects that are left out, or that are drawn.
export interface ObjectLayer extends ObjectRange {
  readonly isOut: boolean;
}

export class LeftOutObjects implements Omission {
  readonly uniforms = { leavesObjectsOut: { value: false }, leftOutObjects: { value: null as DataTexture | null } };
  isUsed = false;
  version = 0;

  /// `objectAt`: the object of a tile's vertex; null: it has none.
  constructor(private readonly objectAt: (tile: Tile, vertex: number) => number | null) {}

  readonly edit = (shader: Shader): void => {
    replaceChunk(shader, 'vertexShader', 'project_vertex', LEFT_OUT);
    shader.vertexShader = `attribute float object;\nuniform bool leavesObjectsOut;\nuniform highp sampler2D leftOutObjects;\n${shader.vertexShader}`;
  };

  omits(tile: Tile, vertex: number): boolean {
    const object = this.uniforms.leavesObjectsOut.value ? this.objectAt(tile, vertex) : null;
    return object !== null && this.has(object);
  }

  has(object: number): boolean {
    const { leavesObjectsOut, leftOutObjects: { value } } = this.uniforms;
    return leavesObjectsOut.value && (value?.image.data as Uint8Array | undefined)?.[object] === OUT;
  }

  /// Each layer goes over those before it; of none all `count` objects are drawn.
  set(layers: readonly ObjectLayer[], count: number): void {
    const { leavesObjectsOut, leftOutObjects } = this.uniforms;
    const isAny = layers.some(({ isOut }) => isOut);
    ++this.version;
    this.isUsed ||= isAny;
    leavesObjectsOut.value = isAny;
    leftOutObjects.value?.dispose();
    leftOutObjects.value = null;
    if (!isAny) return;
    const states = texelBytes(count, 1);
    for (const { begin, end, isOut } of layers) states.fill(isOut ? OUT : 0, begin, end);
    leftOutObjects.value = texelTexture(states, 1);
  }
}
