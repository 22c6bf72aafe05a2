// SPDX-License-Identifier: MIT
// Draws a closed model cut open by planes, with caps where it is full: the stencil counts backs less fronts behind a plane.
// The renderer needs a stencil buffer: `new WebGLRenderer({ stencil: true })`.
import {
  AlwaysStencilFunc, BackSide, DecrementWrapStencilOp, DoubleSide, FrontSide, IncrementWrapStencilOp, Mesh, MeshBasicMaterial, NotEqualStencilFunc,
  PlaneGeometry, Scene, Vector3, type Camera, type ColorRepresentation, type Material, type Object3D, type Plane, type Side, type StencilOp, type WebGLRenderer,
} from 'three';
import { alone } from '../scene/alone.js';
import { isParallel, towardsViewer, type ViewCamera } from '../scene/projection.js';

const COLOUR = 0xd9825b;

function counting(side: Side, op: StencilOp): MeshBasicMaterial {
  return new MeshBasicMaterial({
    side, colorWrite: false, depthWrite: false, depthTest: false,
    stencilWrite: true, stencilFunc: AlwaysStencilFunc, stencilFail: op, stencilZFail: op, stencilZPass: op,
  });
}

/// Tells whether a plane is seen from the side that is cut away.
function seesBehind(camera: ViewCamera, plane: Plane): boolean {
  if (isParallel(camera)) return plane.normal.dot(towardsViewer(camera)) < 0;
  return plane.distanceToPoint(new Vector3().setFromMatrixPosition(camera.matrixWorld)) < 0;
}

export class ClippedPainter {
  /// In the world.
  planes: readonly Plane[] = [];
  isCapped = true;
  private readonly backs = counting(BackSide, IncrementWrapStencilOp);
  private readonly fronts = counting(FrontSide, DecrementWrapStencilOp);
  private readonly cap: Mesh<PlaneGeometry, MeshBasicMaterial>;
  private readonly capScene = new Scene();

  /// `reach`: of the model, in the world, from its middle to its farthest point. `prepare`: is given materials that count, before each pass.
  constructor(
    private readonly model: Object3D,
    private readonly extent: () => { readonly middle: Vector3; readonly reach: number },
    colour: ColorRepresentation = COLOUR,
    private readonly prepare: (material: Material) => void = () => undefined,
  ) {
    this.cap = new Mesh(new PlaneGeometry(2, 2), new MeshBasicMaterial({
      color: colour, side: DoubleSide, toneMapped: false, stencilWrite: true, stencilRef: 0, stencilFunc: NotEqualStencilFunc,
    }));
    this.capScene.add(this.cap);
  }

  /// Instead of `renderer.render(scene, camera)`.
  paint(renderer: WebGLRenderer, scene: Scene, camera: ViewCamera): void {
    const { autoClear, clippingPlanes } = renderer;
    renderer.clippingPlanes = [...this.planes];
    renderer.render(scene, camera);
    renderer.autoClear = false;
    // From its kept side no cap is seen.
    if (this.isCapped) for (const plane of this.planes) if (seesBehind(camera, plane)) this.paintCap(renderer, scene, camera, plane);
    Object.assign(renderer, { autoClear, clippingPlanes });
  }

  private paintCap(renderer: WebGLRenderer, scene: Scene, camera: Camera, plane: Plane): void {
    renderer.clearStencil();
    renderer.clippingPlanes = [plane];
    this.count(renderer, scene, camera);
    renderer.clippingPlanes = this.planes.filter((other) => other !== plane);
    this.place(plane);
    renderer.render(this.capScene, camera);
  }

  private count(renderer: WebGLRenderer, scene: Scene, camera: Camera): void {
    alone(scene, this.model, () => {
      for (const material of [this.backs, this.fronts]) {
        this.prepare(material);
        scene.overrideMaterial = material;
        renderer.render(scene, camera);
      }
    });
  }

  private place(plane: Plane): void {
    const { middle, reach } = this.extent();
    plane.projectPoint(middle, this.cap.position);
    this.cap.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), plane.normal);
    this.cap.scale.setScalar(reach);
  }

  dispose(): void {
    for (const material of [this.backs, this.fronts, this.cap.material]) material.dispose();
    this.cap.geometry.dispose();
  }
}
