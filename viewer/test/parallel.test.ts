// SPDX-License-Identifier: MIT
import { Box3, Matrix4, OrthographicCamera, PerspectiveCamera, Raycaster, Vector2, Vector3 } from 'three';
import { afterAll, describe, expect, it } from 'vitest';
import { comesFromOutside, distance, looksAway, pixelsOf, type Box } from '../src/cut/viewpoint.js';
import { HierarchyView } from '../src/index.js';
import { axesOf, frameWhole } from '../src/scene/framing.js';
import { viewpointOf } from '../src/scene/motion.js';
import { heightAt, isParallel, SwitchingCamera, towardsViewer } from '../src/scene/projection.js';
import { rayThrough } from '../src/tools/pick.js';
import { TileScene } from '../src/scene/tile_scene.js';
import { fetchFrom, hasProgram, Workshop } from './support/meshhier.js';

const SIZE = { width: 400, height: 300 };

function parallelCamera(height: number, from = new Vector3(3, 4, 5)): SwitchingCamera {
  const camera = new SwitchingCamera(45, 4 / 3, 1, 100);
  camera.parallelHeight = height;
  camera.position.copy(from);
  camera.lookAt(0, 0, 0);
  camera.updateProjectionMatrix();
  camera.updateMatrixWorld();
  return camera;
}

function objectWith(matrix = new Matrix4()): TileScene {
  const object = new TileScene(() => undefined, () => undefined);
  object.matrixWorld.copy(matrix);
  return object;
}

describe('a camera that switches', () => {
  it('projects as the two of three do, also parts of the picture', () => {
    const camera = parallelCamera(6);
    const [straight, orthographic] = [new PerspectiveCamera(45, 4 / 3, 1, 100), new OrthographicCamera(-4, 4, 3, -3, 1, 100)];
    const compare = (other: PerspectiveCamera | OrthographicCamera): void => {
      camera.projectionMatrix.elements.forEach((value, i) => { expect(value).toBeCloseTo(other.projectionMatrix.elements[i], 12); });
      camera.projectionMatrixInverse.elements.forEach((value, i) => { expect(value).toBeCloseTo(other.projectionMatrixInverse.elements[i], 9); });
    };
    compare(orthographic);
    for (const each of [camera, orthographic]) each.setViewOffset(400, 300, 100, 30, 50, 60);
    compare(orthographic);
    expect([isParallel(camera), camera.isPerspectiveCamera]).toEqual([true, false]);
    camera.clearViewOffset();
    camera.parallelHeight = null;
    camera.updateProjectionMatrix();
    compare(straight);
    expect([isParallel(camera), camera.isPerspectiveCamera, (camera as unknown as OrthographicCamera).isOrthographicCamera]).toEqual([false, true, false]);
  });

  it('shows what is at the target equally large in both ways', () => {
    const [angle, away] = [Math.PI / 4, 7];
    const one = new PerspectiveCamera(45, 4 / 3, 1, 100);
    const other = parallelCamera(heightAt(away, angle), new Vector3(0, 0, away));
    one.position.set(0, 0, away);
    one.updateMatrixWorld();
    const at = new Vector3(1, -2, 0);
    const [a, b] = [one, other].map((camera) => at.clone().project(camera));
    expect([a.x, a.y]).toEqual([expect.closeTo(b.x, 12), expect.closeTo(b.y, 12)]);
  });
});

describe('parallel rays', () => {
  const near: Box = { min: [1, 1, 1], max: [2, 2, 2] };
  const far: Box = { min: [-9, -9, -9], max: [-8, -8, -8] };

  it('see a length equally long at all depths, in pixels of the picture', () => {
    const view = viewpointOf(parallelCamera(6), objectWith(), SIZE);
    expect([pixelsOf(view, near, 0.5), pixelsOf(view, far, 0.5)]).toEqual([expect.closeTo(25, 9), expect.closeTo(25, 9)]);
    expect(distance(view, near)).toBeLessThan(distance(view, far));
  });

  it('see what is stretched as large as it is at most', () => {
    const stretched = viewpointOf(parallelCamera(6), objectWith(new Matrix4().makeScale(2, 6, 2)), SIZE);
    expect(pixelsOf(stretched, near, 0.5)).toBeCloseTo(6 * 25, 9);
    expect(looksAway(stretched, near, { axis: [0, -1, 0], cosine: 1 }, 0)).toBe(false);
  });

  it('know from which side they come, also where the object is turned', () => {
    const matrix = new Matrix4().makeRotationX(-Math.PI / 2).setPosition(5, 6, 7);
    const camera = parallelCamera(6);
    const view = viewpointOf(camera, objectWith(matrix), SIZE);
    const [x, y, z] = view.towards!;
    expect(new Vector3(x, y, z).transformDirection(matrix).distanceTo(towardsViewer(camera))).toBeLessThan(1e-12);
    const away = { axis: [-x, -y, -z] as const, cosine: Math.cos(0.3) };
    for (const box of [near, far]) {
      expect(looksAway(view, box, away, 0.1)).toBe(true);
      expect(looksAway(view, box, away, 1.4)).toBe(false); // not by so much
      expect(looksAway(view, box, { axis: [x, y, z], cosine: 1 }, 0)).toBe(false);
    }
  });

  it('come from outside where the near plane is before all of a box', () => {
    const view = (from: Vector3): ReturnType<typeof viewpointOf> => viewpointOf(parallelCamera(6, from), objectWith(), SIZE);
    const box: Box = { min: [-1, -1, -1], max: [1, 1, 1] };
    expect([view(new Vector3(0, 0, 5)), view(new Vector3(0, 0, 1.9)), view(new Vector3(0, 0, -3))].map((each) => comesFromOutside(each, box))).toEqual([true, false, true]);
  });

  it('go where three sends them', () => {
    const camera = parallelCamera(6);
    const raycaster = new Raycaster();
    const matrix = new Matrix4().makeTranslation(1, 2, 3);
    for (const [right, up] of [[0, 0], [0.5, -0.75], [-1, 1]]) {
      raycaster.setFromCamera(new Vector2(right, up), camera);
      const { from, direction } = rayThrough(camera, right, up, matrix);
      expect(new Vector3(...direction).distanceTo(raycaster.ray.direction)).toBeLessThan(1e-12);
      expect(raycaster.ray.distanceToPoint(new Vector3(...from).applyMatrix4(matrix))).toBeLessThan(1e-12);
      const depth = new Vector3(...from).applyMatrix4(matrix).applyMatrix4(camera.matrixWorldInverse).z;
      expect(depth).toBeCloseTo(-camera.near, 12);
    }
  });

  it('frame a shape so that it touches the borders of the picture, but for the margin', () => {
    const box = new Box3(new Vector3(-3, -1, -2), new Vector3(5, 1, 2));
    for (const aspect of [0.5, 2]) {
      const { position, target } = frameWhole([], box, [0, 0, 1], Math.PI / 4, aspect, 'parallel');
      const height = heightAt(position.distanceTo(target), Math.PI / 4);
      expect(target.toArray().slice(0, 2)).toEqual([1, 0]);
      expect(Math.max(8 / (height * aspect), 2 / height)).toBeCloseTo(1 / 1.08, 9);
    }
    expect(axesOf(new Vector3(0, -1, 0)).up.toArray().map((value) => value + 0)).toEqual([0, 0, -1]);
  });
});

describe.skipIf(!hasProgram)('a hierarchy seen in parallel', () => {
  const workshop = new Workshop();
  afterAll(() => { workshop.remove(); });

  it('has the error that is allowed at all depths, and its back is left coarse', async () => {
    const directory = workshop.build('sphere', ['surface', '--triangles', '24000', '--height', '0.05'], { partition: { vertices: 100 } });
    const view = new HierarchyView('', { fetch: fetchFrom(directory), settings: { threshold: 0.05, restDetail: 1 } });
    const camera = new OrthographicCamera(-1.6, 1.6, 1.2, -1.2, 0.1, 100);
    camera.position.set(0, 0, 50);
    await view.opened;
    let now = 0;
    const settle = async (): Promise<void> => {
      do {
        view.update(camera, SIZE, (now += 100));
        await new Promise((resolve) => setImmediate(resolve));
      } while (!view.stats().settled);
    };
    await settle();
    const { tiles, worstError } = view.stats();
    expect(worstError).toBeLessThanOrEqual(0.05);
    camera.position.z = 5;
    await settle();
    expect(view.stats()).toMatchObject({ tiles, worstError });
    view.showsInside = true;
    await settle();
    expect(view.stats().tiles).toBeGreaterThan(tiles);
    view.dispose();
  });
});
