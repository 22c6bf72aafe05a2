// SPDX-License-Identifier: MIT
// A plug-in: lines of equal height on the model, and a button for them.
import { replaceChunk } from 'meshhier-viewer';

export class Contours {
  name = 'contours';
  strength = { value: 0.6 };
  shading = {
    uniforms: { contourStep: { value: 1 }, contourStrength: this.strength },
    key: () => 'contours',
    edit: (shader) => {
      shader.vertexShader = `varying float vUp;\n${shader.vertexShader}`;
      shader.fragmentShader = `varying float vUp;\nuniform float contourStep, contourStrength;\n${shader.fragmentShader}`;
      replaceChunk(shader, 'vertexShader', 'begin_vertex', '#include <begin_vertex>\nvUp = dot(position, upwards);');
      replaceChunk(shader, 'fragmentShader', 'color_fragment', `#include <color_fragment>
        float contour = vUp / contourStep, away = abs(fract(contour + 0.5) - 0.5) / fwidth(contour);
        diffuseColor.rgb *= 1.0 - contourStrength * (1.0 - smoothstep(0.6, 1.2, away));`);
    },
  };

  init(view) {
    view.opened.then(() => { this.shading.uniforms.contourStep.value = (view.box.max.y - view.box.min.y) / 20; }, () => undefined);
  }

  enter(stage) {
    const switched = () => {
      this.strength.value = 0.6 - this.strength.value;
      stage.redraw();
    };
    this.button = Object.assign(document.createElement('button'), { textContent: 'Contours', style: 'position: absolute; top: 1em; left: 1em', onclick: switched });
    stage.root.append(this.button);
  }

  dispose() {
    this.button?.remove();
  }
}
