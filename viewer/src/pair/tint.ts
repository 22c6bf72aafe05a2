// SPDX-License-Identifier: MIT
// One colour for all of a model, with its light and shade.
import { Color, type ColorRepresentation } from 'three';
import type { Plugin } from '../scene/hierarchy_view.js';
import { replaceChunk, type Shading } from '../scene/shading.js';

export class Tint implements Plugin {
  readonly name = 'pair tint';
  readonly shading: Shading;

  constructor(colour: ColorRepresentation) {
    this.shading = {
      uniforms: { pairTint: { value: new Color(colour) } },
      isForUnlit: true,
      key: () => 'pair tint',
      edit: (shader) => {
        shader.fragmentShader = `uniform vec3 pairTint;\n${shader.fragmentShader}`;
        replaceChunk(shader, 'fragmentShader', 'color_fragment', '#include <color_fragment>\ndiffuseColor.rgb = pairTint;');
      },
    };
  }
}
