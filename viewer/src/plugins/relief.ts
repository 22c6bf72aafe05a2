// SPDX-License-Identifier: MIT
// Slopes are shaded as steep as a look says, and what bends within pixels stands out, as scratches and letters do. Normal maps stay as they
// are: of slopes that are to be twenty times steeper their eight bits tell little but how they were rounded.
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

  key({ material }: Look): string {
    return material === 'relief' ? 'relief' : 'slopes';
  }

  edit(shader: Shader, { material }: Look): void {
    replaceChunk(shader, 'vertexShader', 'beginnormal_vertex', SLOPES);
    if (material === 'relief') replaceChunk(shader, 'fragmentShader', 'normal_fragment_maps', CAVITIES);
    shader.vertexShader = `uniform float relief;\n${shader.vertexShader}`;
  }

  show({ relief }: Look): void {
    this.uniforms.relief.value = relief;
  }
}
