// SPDX-License-Identifier: MIT
// Little light comes to hollows: ambient occlusion of what is on the screen, by three's pass (ground-truth ambient
// occlusion, Jimenez et al. 2016), multiplied onto a picture that is drawn already.
import {
  CustomBlending, DepthTexture, DoubleSide, MeshBasicMaterial, OneFactor, ShaderMaterial, SrcColorFactor, UnsignedIntType, Vector2, WebGLRenderTarget, ZeroFactor,
  Vector3, type Scene, type WebGLRenderer,
} from 'three';
import { GTAOPass } from 'three/addons/postprocessing/GTAOPass.js';
import { FullScreenQuad } from 'three/addons/postprocessing/Pass.js';
import { alone } from '../scene/alone.js';
import type { HierarchyView, Plugin, Stage } from '../scene/hierarchy_view.js';
import { isParallel, type ViewCamera } from '../scene/projection.js';
import type { Frame } from './plugin.js';

/// Hollows of this part of the camera's distance are shaded, however near the camera is.
const REACH = 0.1;
const MOST_RATIO = 2; // pixels of the canvas for one of the page
const QUALITY = { samples: 32, distanceExponent: 1.4, distanceFallOff: 0.5, scale: 1.5 };
const SMOOTHING = { lumaPhi: 20, depthPhi: 4, normalPhi: 2, radius: 10, radiusExponent: 1, rings: 3, samples: 24 };

const VERTEX = 'varying vec2 place;\nvoid main() { place = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }';
const FRAGMENT = 'uniform sampler2D light;\nvarying vec2 place;\nvoid main() { gl_FragColor = vec4(texture2D(light, place).rrr, 1.0); }';

/// The picture times the light, its opacity as it is.
function multiplying(): ShaderMaterial {
  return new ShaderMaterial({
    uniforms: { light: { value: null } }, vertexShader: VERTEX, fragmentShader: FRAGMENT, depthTest: false, depthWrite: false, transparent: true,
    blending: CustomBlending, blendSrc: ZeroFactor, blendDst: SrcColorFactor, blendSrcAlpha: ZeroFactor, blendDstAlpha: OneFactor,
  });
}

/// Shades the hollows of one scene, for one camera.
class Hollows {
  private readonly depth = new WebGLRenderTarget(1, 1, { depthTexture: new DepthTexture(1, 1, UnsignedIntType) });
  /// The depth alone counts of whatever is drawn.
  private readonly bare = new MeshBasicMaterial({ side: DoubleSide, colorWrite: false });
  private readonly tiles = this.bare.clone();
  private readonly pass: GTAOPass;
  private readonly multiply = multiplying();
  private readonly quad = new FullScreenQuad(this.multiply);
  private readonly size = new Vector2();

  /// The pass is made for one projection.
  readonly isParallel: boolean;

  constructor(readonly scene: Scene, readonly camera: ViewCamera, private readonly view: HierarchyView) {
    this.isParallel = isParallel(camera);
    this.pass = new GTAOPass(scene, camera, 1, 1, { depthTexture: this.depth.depthTexture! });
    this.pass.updateGtaoMaterial(QUALITY);
    this.pass.updatePdMaterial(SMOOTHING);
    this.pass.output = GTAOPass.OUTPUT.Off;
    this.pass.pdMaterial.uniforms.tNoise.value = this.pass.gtaoNoiseTexture; // its own is another one each time: a link shows what it showed
    this.multiply.uniforms.light.value = this.pass.gtaoMap;
  }

  /// Shades what was drawn on the canvas. `distance`: to what the camera looks at. `ratio`: pixels of the canvas for one here.
  shade(renderer: WebGLRenderer, distance: number, ratio: number): void {
    this.fit(renderer, ratio);
    const target = renderer.getRenderTarget();
    const reach = REACH * distance;
    this.pass.updateGtaoMaterial({ radius: reach, thickness: reach });
    this.drawDepth(renderer);
    this.pass.render(renderer, this.depth, this.depth, 0, false);
    renderer.setRenderTarget(target);
    const { autoClear } = renderer;
    renderer.autoClear = false;
    this.quad.render(renderer);
    renderer.autoClear = autoClear;
  }

  dispose(): void {
    this.depth.depthTexture?.dispose();
    this.depth.dispose();
    this.bare.dispose();
    this.tiles.dispose();
    this.pass.dispose();
    this.multiply.dispose();
    this.quad.dispose();
  }

  private fit(renderer: WebGLRenderer, ratio: number): void {
    const { x, y } = renderer.getDrawingBufferSize(new Vector2()).divideScalar(ratio).ceil();
    if (this.size.x === x && this.size.y === y) return;
    this.size.set(x, y);
    this.depth.setSize(x, y);
    this.pass.setSize(x, y);
  }

  /// What plug-ins leave out of tiles has no depth, either: then tiles are drawn after all else.
  private drawDepth(renderer: WebGLRenderer): void {
    const { scene, view, bare } = this;
    const { overrideMaterial } = scene;
    const { visible } = view;
    const leavesOut = view.leaveOut(this.tiles);
    bare.side = this.tiles.side = view.side;
    scene.overrideMaterial = bare;
    renderer.setRenderTarget(this.depth);
    view.visible &&= !leavesOut;
    renderer.render(scene, this.camera);
    view.visible = visible;
    scene.overrideMaterial = overrideMaterial;
    if (leavesOut) this.drawTiles(renderer);
  }

  private drawTiles(renderer: WebGLRenderer): void {
    const { scene, view, camera } = this;
    const { autoClear } = renderer;
    renderer.autoClear = false;
    alone(scene, view, () => {
      scene.overrideMaterial = this.tiles;
      renderer.render(scene, camera);
    });
    renderer.autoClear = autoClear;
  }
}

/// Hollows get less light while it is registered; not in pictures that a plug-in has painted.
export class Occlusion implements Plugin {
  private view: HierarchyView | null = null;
  private stage: Stage | null = null;
  private hollows: Hollows | null = null;

  constructor(readonly name = 'occlusion') {}

  init(view: HierarchyView): void {
    this.view = view;
  }

  enter(stage: Stage): void {
    this.stage = stage;
  }

  /// A part of a larger picture does not know what lies beside it: there hollows are as they are.
  shade({ renderer, scene, camera }: Frame): void {
    if (camera.view?.enabled === true) return;
    if (this.hollows?.scene !== scene || this.hollows.camera !== camera || this.hollows.isParallel !== isParallel(camera)) {
      this.hollows?.dispose();
      this.hollows = new Hollows(scene, camera, this.view!);
    }
    this.hollows.shade(renderer, this.distanceOf(camera), Math.min(devicePixelRatio, MOST_RATIO));
  }

  dispose(): void {
    this.hollows?.dispose();
    this.view = this.stage = this.hollows = null;
  }

  /// To what the camera looks at: without a stage, the middle of the model.
  private distanceOf(camera: ViewCamera): number {
    if (this.stage !== null) return this.stage.pose().distance;
    const middle = this.view!.box.getCenter(new Vector3()).applyMatrix4(this.view!.matrixWorld);
    return middle.distanceTo(new Vector3().setFromMatrixPosition(camera.matrixWorld));
  }
}
