// SPDX-License-Identifier: MIT
// Draws a line around the marked object, over a picture that is drawn already, also where something hides the object: its triangles are drawn
// to a mask, as far as no plane cuts them away, and what lies beside the mask is the line.
import { Color, DoubleSide, MeshBasicMaterial, ShaderMaterial, Vector2, WebGLRenderTarget, type IUniform } from 'three';
import { FullScreenQuad } from 'three/addons/postprocessing/Pass.js';
import { alone } from '../scene/alone.js';
import type { HierarchyView } from '../scene/hierarchy_view.js';
import { replaceChunk } from '../scene/shading.js';
import type { Frame } from './plugin.js';

const WIDTH = 2; // pixels of the page
const DIRECTIONS = 12;

/// All other triangles lie where nothing is seen.
const MARKED = `#include <project_vertex>
if (abs(object - markedObject) > 0.5) gl_Position = vec4(0.0, 0.0, 2.0, 1.0);`;

const LINE_VERTEX = 'varying vec2 place;\nvoid main() { place = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }';
const LINE = `uniform sampler2D mask;
uniform vec2 reach;
uniform vec3 objectMark;
varying vec2 place;
void main() {
  float near = 0.0;
  for (int i = 0; i < ${DIRECTIONS}; ++i) {
    float angle = float(i) * ${((2 * Math.PI) / DIRECTIONS).toFixed(6)};
    near += texture2D(mask, place + reach * vec2(cos(angle), sin(angle))).r;
  }
  gl_FragColor = vec4(objectMark, clamp(near * 0.5, 0.0, 1.0) * (1.0 - texture2D(mask, place).r));
}`;

export class ObjectOutline {
  private readonly target = new WebGLRenderTarget(1, 1, { depthBuffer: false });
  private readonly mask: MeshBasicMaterial;
  private readonly line: ShaderMaterial;
  private readonly quad: FullScreenQuad;
  private readonly size = new Vector2();

  /// `mark`: a screen's colour. `marked`: the object, whatever it is in each frame.
  constructor(marked: IUniform<number>, mark: Color) {
    this.mask = maskOf(marked);
    const uniforms = { mask: { value: this.target.texture }, reach: { value: new Vector2() }, objectMark: { value: mark } };
    this.line = new ShaderMaterial({ uniforms, vertexShader: LINE_VERTEX, fragmentShader: LINE, depthTest: false, depthWrite: false, transparent: true });
    this.quad = new FullScreenQuad(this.line);
  }

  /// `view`: has the object.
  draw(frame: Frame, view: HierarchyView): void {
    const { renderer } = frame;
    renderer.getDrawingBufferSize(this.size);
    this.target.setSize(this.size.x, this.size.y);
    (this.line.uniforms.reach.value as Vector2).set(1, 1).divide(this.size).multiplyScalar(WIDTH * renderer.getPixelRatio());
    this.drawMask(frame, view);
    const { autoClear } = renderer;
    renderer.autoClear = false;
    this.quad.render(renderer);
    renderer.autoClear = autoClear;
  }

  dispose(): void {
    this.target.dispose();
    this.mask.dispose();
    this.line.dispose();
    this.quad.dispose();
  }

  private drawMask({ renderer, scene, camera }: Frame, view: HierarchyView): void {
    const [colour, alpha, { clippingPlanes }] = [renderer.getClearColor(new Color()), renderer.getClearAlpha(), renderer];
    renderer.setClearColor(0, 0);
    renderer.clippingPlanes = [...view.plugins.cuts];
    renderer.setRenderTarget(this.target);
    alone(scene, view, () => {
      this.mask.side = view.side;
      scene.overrideMaterial = this.mask;
      renderer.render(scene, camera);
    });
    renderer.setRenderTarget(null);
    renderer.clippingPlanes = clippingPlanes;
    renderer.setClearColor(colour, alpha);
  }
}

/// White where the object is.
function maskOf(markedObject: IUniform<number>): MeshBasicMaterial {
  const mask = new MeshBasicMaterial({ side: DoubleSide, toneMapped: false, depthTest: false, depthWrite: false });
  mask.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, { markedObject });
    replaceChunk(shader, 'vertexShader', 'project_vertex', MARKED);
    shader.vertexShader = `attribute float object;\nuniform float markedObject;\n${shader.vertexShader}`;
  };
  mask.customProgramCacheKey = () => 'meshhier-marked-object';
  return mask;
}
