// SPDX-License-Identifier: MIT
// Draws a line around the marked object, over a picture that is drawn already, also where something hides the object: its triangles are drawn
// to a mask, and what lies beside the mask is the line.
import { Color, DoubleSide, ShaderMaterial, Vector2, WebGLRenderTarget, type IUniform } from 'three';
import { FullScreenQuad } from 'three/addons/postprocessing/Pass.js';
import type { Frame } from './plugin.js';

const WIDTH = 2; // pixels of the page
const DIRECTIONS = 12;

const MASK_VERTEX = `attribute float object;
flat varying float vObject;
void main() {
  vObject = object;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;
const MASK = `uniform float markedObject;
flat varying float vObject;
void main() {
  if (abs(vObject - markedObject) > 0.5) discard;
  gl_FragColor = vec4(1.0);
}`;

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
  private readonly mask: ShaderMaterial;
  private readonly line: ShaderMaterial;
  private readonly quad: FullScreenQuad;
  private readonly size = new Vector2();

  /// `mark`: a screen's colour. `marked`: the object, whatever it is in each frame.
  constructor(marked: IUniform<number>, mark: Color) {
    this.mask = new ShaderMaterial({ uniforms: { markedObject: marked }, vertexShader: MASK_VERTEX, fragmentShader: MASK, side: DoubleSide, depthTest: false, depthWrite: false });
    const uniforms = { mask: { value: this.target.texture }, reach: { value: new Vector2() }, objectMark: { value: mark } };
    this.line = new ShaderMaterial({ uniforms, vertexShader: LINE_VERTEX, fragmentShader: LINE, depthTest: false, depthWrite: false, transparent: true });
    this.quad = new FullScreenQuad(this.line);
  }

  draw(frame: Frame): void {
    const { renderer } = frame;
    renderer.getDrawingBufferSize(this.size);
    this.target.setSize(this.size.x, this.size.y);
    (this.line.uniforms.reach.value as Vector2).set(1, 1).divide(this.size).multiplyScalar(WIDTH * renderer.getPixelRatio());
    this.drawMask(frame);
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

  private drawMask({ renderer, scene, camera }: Frame): void {
    const [colour, alpha, { overrideMaterial, background }] = [renderer.getClearColor(new Color()), renderer.getClearAlpha(), scene];
    renderer.setClearColor(0, 0);
    [scene.overrideMaterial, scene.background] = [this.mask, null];
    renderer.setRenderTarget(this.target);
    renderer.render(scene, camera);
    renderer.setRenderTarget(null);
    [scene.overrideMaterial, scene.background] = [overrideMaterial, background];
    renderer.setClearColor(colour, alpha);
  }
}
