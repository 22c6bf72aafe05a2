// SPDX-License-Identifier: MIT
// Slopes are shaded as steep as a look says, and what bends within pixels stands out, as scratches and letters do.
import { Vector2 } from 'three';
import { cavitiesBy } from '../scene/materials.js';
import type { Look } from '../scene/settings.js';
import { replaceChunk, type Shader, type Shading } from '../scene/shading.js';
import type { PluginOf } from './plugin.js';

const SLOPES = `#include <beginnormal_vertex>
vec3 along = dot(objectNormal, upwards) * upwards;
objectNormal = (objectNormal - along) * relief + along;`;

const CAVITIES = cavitiesBy({ strength: 9, least: 0.15, most: 2 });

export class Relief implements PluginOf<unknown>, Shading {
  readonly name = 'relief';
  readonly shading: Shading = this;
  readonly uniforms = { relief: { value: 1 } };
  /// The details of normal maps are as many times steeper as the surface is, along both of their axes.
  private readonly detail = new Vector2(1, 1);

  key({ material }: Look): string {
    return material === 'relief' ? 'relief' : 'slopes';
  }

  edit(shader: Shader, { material }: Look): void {
    replaceChunk(shader, 'vertexShader', 'beginnormal_vertex', SLOPES);
    if (material === 'relief') replaceChunk(shader, 'fragmentShader', 'normal_fragment_maps', CAVITIES);
    shader.vertexShader = `uniform float relief;\n${shader.vertexShader}`;
  }

  parameters(): { normalScale: Vector2 } {
    return { normalScale: this.detail };
  }

  show({ relief }: Look): void {
    this.uniforms.relief.value = relief;
    this.detail.setScalar(relief);
  }
}
