// SPDX-License-Identifier: MIT
import { Group, Mesh, MeshBasicMaterial, PerspectiveCamera, Plane, Points, Scene, Vector3, type Material, type WebGLRenderer } from 'three';
import { describe, expect, it } from 'vitest';
import { ClippedPainter } from '../../src/tools/caps.js';

interface Pass {
  readonly planes: readonly Plane[];
  readonly isCap: boolean;
  readonly override: Material | null;
  readonly drawn: number;
  readonly position: Vector3;
  readonly normal: Vector3;
}

/// A renderer that only notes what it is asked for.
class Notes {
  autoClear = true;
  clippingPlanes: Plane[] = [];
  cleared = 0;
  readonly passes: Pass[] = [];

  constructor(private readonly own: Scene) {}

  clearStencil(): void {
    ++this.cleared;
  }

  render(scene: Scene): void {
    let drawn = 0;
    scene.traverseVisible((object) => { drawn += 'isMesh' in object || 'isPoints' in object ? 1 : 0; });
    const cap = scene.children[0];
    this.passes.push({
      planes: this.clippingPlanes, isCap: scene !== this.own, override: scene.overrideMaterial, drawn,
      position: cap.position.clone(), normal: new Vector3(0, 0, 1).applyQuaternion(cap.quaternion),
    });
  }
}

function paint(planes: readonly Plane[], isCapped = true, prepared: Material[] = []): Notes {
  const scene = new Scene();
  const model = new Group();
  const surface = new Mesh(undefined, new MeshBasicMaterial());
  surface.add(new Points());
  model.add(surface);
  scene.add(model, new Mesh()); // and something that is none of the model
  const painter = new ClippedPainter(model, () => ({ middle: new Vector3(1, 2, 3), reach: 9 }), 0xffffff, (material) => { prepared.push(material); });
  Object.assign(painter, { planes, isCapped });
  const camera = new PerspectiveCamera();
  camera.position.set(0, 0, 10);
  camera.updateMatrixWorld();
  const notes = new Notes(scene);
  painter.paint(notes as unknown as WebGLRenderer, scene, camera);
  expect([notes.autoClear, notes.clippingPlanes, scene.overrideMaterial]).toEqual([true, [], null]);
  scene.traverse(({ visible }) => { expect(visible).toBe(true); });
  painter.dispose();
  return notes;
}

const AWAY = new Plane(new Vector3(0, 0, -1), 5); // the camera is on the side that is cut away
const TILTED = new Plane(new Vector3(1, 0, -1).normalize(), 0);
const TOWARDS = new Plane(new Vector3(0, 0, 1), 5);

describe('caps', () => {
  it('lie in their planes, look where these do, and are as large as the model', () => {
    const { passes } = paint([AWAY, TILTED]);
    const caps = passes.filter(({ isCap }) => isCap);
    expect(caps).toHaveLength(2);
    for (const [i, plane] of [AWAY, TILTED].entries()) {
      expect(plane.distanceToPoint(caps[i].position)).toBeCloseTo(0, 12);
      expect(caps[i].normal.distanceTo(plane.normal)).toBeCloseTo(0, 12);
    }
  });

  it('are cut by the other planes, not by their own, which alone counts', () => {
    const { passes, cleared } = paint([AWAY, TILTED]);
    expect(cleared).toBe(2);
    expect(passes.map(({ planes }) => planes)).toEqual([[AWAY, TILTED], [AWAY], [AWAY], [TILTED], [TILTED], [TILTED], [AWAY]]);
  });

  it('count the backs up and the fronts down of the surface alone', () => {
    const [whole, backs, fronts] = paint([AWAY]).passes;
    expect([whole.drawn, backs.drawn, fronts.drawn]).toEqual([3, 1, 1]);
    expect(backs.override).toMatchObject({ side: 1, colorWrite: false, depthTest: false, stencilWrite: true });
    expect(fronts.override).toMatchObject({ side: 0, colorWrite: false, depthTest: false, stencilWrite: true });
    expect([backs.override?.stencilZPass, fronts.override?.stencilZPass]).toEqual([34055, 34056]); // INCR_WRAP, DECR_WRAP
  });

  it('leave out what whoever prepares their materials leaves out', () => {
    const prepared: Material[] = [];
    const counting = paint([AWAY, TILTED], true, prepared).passes.flatMap(({ override }) => override ?? []);
    expect(prepared).toEqual(counting);
    expect(prepared).toHaveLength(4);
  });

  it('are not drawn from the side that is kept, nor where they are not wanted', () => {
    expect(paint([TOWARDS]).passes.map(({ planes }) => planes)).toEqual([[TOWARDS]]);
    expect(paint([AWAY], false).passes).toHaveLength(1);
    expect(paint([]).passes.map(({ planes }) => planes)).toEqual([[]]);
  });
});
