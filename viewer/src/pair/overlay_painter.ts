// SPDX-License-Identifier: MIT
// Two models in one picture, each drawn by itself: of both the nearer one is seen.
//
// Problem: where two surfaces lie on each other, depth alone decides by rounding: specks of both colours.
// Idea: each is drawn into a picture of its own with its depth; a pass over both lets the nearer one through, and where they are
// closer to each other than about three pixels are wide, the colours pass over into one another.
// Cost: two pictures of the canvas's size, and a pass over it.
import {
  DepthStencilFormat, DepthTexture, HalfFloatType, NoBlending, ShaderMaterial, UnsignedInt248Type, Vector2, WebGLRenderTarget, type WebGLRenderer,
} from 'three';
import { isParallel, type ViewCamera } from '../scene/projection.js';
import { FullScreenQuad } from 'three/addons/postprocessing/Pass.js';

const SAMPLES = 4;
const BAND = 3; // pixels

const VERTEX = 'varying vec2 place;\nvoid main() { place = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }';
const FRAGMENT = `
uniform sampler2D one, other, depthOfOne, depthOfOther;
uniform mat4 unprojection;
uniform float pixel;
uniform bool isParallel;
varying vec2 place;
float away(sampler2D depths) {
  vec4 seen = unprojection * vec4(0.0, 0.0, 2.0 * texture2D(depths, place).x - 1.0, 1.0);
  return -seen.z / seen.w;
}
void main() {
  vec4 a = texture2D(one, place), b = texture2D(other, place);
  float first = away(depthOfOne), second = away(depthOfOther), band = ${BAND.toFixed(1)} * pixel * (isParallel ? 1.0 : min(first, second));
  float front = smoothstep(-band, band, second - first);
  vec4 sum = mix(b + a * (1.0 - b.a), a + b * (1.0 - a.a), front);
  gl_FragColor = vec4(sum.rgb / max(sum.a, 1e-4), sum.a);
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
  gl_FragColor.rgb *= gl_FragColor.a;
}`;

function makeTarget(): WebGLRenderTarget {
  const depthTexture = new DepthTexture(1, 1, UnsignedInt248Type);
  depthTexture.format = DepthStencilFormat;
  return new WebGLRenderTarget(1, 1, { type: HalfFloatType, samples: SAMPLES, stencilBuffer: true, depthTexture });
}

export class OverlayPainter {
  private readonly targets = [makeTarget(), makeTarget()] as const;
  private readonly size = new Vector2();
  private readonly material = new ShaderMaterial({
    uniforms: Object.fromEntries(['one', 'other', 'depthOfOne', 'depthOfOther', 'unprojection', 'pixel', 'isParallel'].map((name) => [name, { value: null }])),
    vertexShader: VERTEX, fragmentShader: FRAGMENT, depthTest: false, depthWrite: false, blending: NoBlending,
  });
  private readonly quad = new FullScreenQuad(this.material);

  constructor() {
    const { one, other, depthOfOne, depthOfOther } = this.material.uniforms;
    [one.value, other.value] = this.targets.map(({ texture }) => texture);
    [depthOfOne.value, depthOfOther.value] = this.targets.map(({ depthTexture }) => depthTexture);
  }

  /// `draw`: the model of that number, with the camera.
  paint(renderer: WebGLRenderer, camera: ViewCamera, draw: (which: 0 | 1) => void): void {
    this.fit(renderer);
    const target = renderer.getRenderTarget();
    for (const which of [0, 1] as const) {
      renderer.setRenderTarget(this.targets[which]);
      draw(which);
    }
    renderer.setRenderTarget(target);
    const { unprojection, pixel, isParallel: parallel } = this.material.uniforms;
    unprojection.value = camera.projectionMatrixInverse;
    pixel.value = 2 / (camera.projectionMatrix.elements[5] * this.size.y);
    parallel.value = isParallel(camera);
    this.quad.render(renderer);
  }

  dispose(): void {
    for (const target of this.targets) {
      target.depthTexture?.dispose();
      target.dispose();
    }
    this.material.dispose();
    this.quad.dispose();
  }

  private fit(renderer: WebGLRenderer): void {
    const { x, y } = renderer.getDrawingBufferSize(new Vector2());
    if (this.size.x === x && this.size.y === y) return;
    this.size.set(x, y);
    for (const target of this.targets) target.setSize(x, y);
  }
}
