// SPDX-License-Identifier: MIT
// All of a shape in a picture, as large as it can be.
import { Box3, Matrix4, PerspectiveCamera, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { axesOf, cornersOf, frameShape, type Slopes } from '../src/scene/framing.js';

const SLOPE = Math.tan(Math.PI / 8);

/// A flat court seen from above its edge, a tower, a cloud: in places of its own.
const SHAPES: Record<string, Vector3[]> = {
  court: [-20, 20].flatMap((x) => [-30, 10].flatMap((z) => [0, 0.3].map((y) => new Vector3(x + 7, y, z)))),
  tower: [-1, 1].flatMap((x) => [-1, 1].flatMap((z) => [0, 40].map((y) => new Vector3(x, y, z)))),
  cloud: Array.from({ length: 200 }, (_, i) => new Vector3(Math.sin(12.9 * i), 0.3 * Math.sin(78.2 * i), 2 * Math.sin(37.7 * i)).addScalar(5)),
};

function bounds(points: readonly Vector3[], { position, target }: { position: Vector3; target: Vector3 }, aspect: number): { x: number[]; y: number[] } {
  const camera = new PerspectiveCamera(45, aspect, 1e-3, 1e4);
  camera.position.copy(position);
  camera.lookAt(target);
  camera.updateMatrixWorld();
  const clip = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
  const seen = points.map((point) => point.clone().applyMatrix4(clip));
  return { x: [Math.min(...seen.map(({ x }) => x)), Math.max(...seen.map(({ x }) => x))], y: [Math.min(...seen.map(({ y }) => y)), Math.max(...seen.map(({ y }) => y))] };
}

describe.each(Object.entries(SHAPES))('a %s', (_, points) => {
  it.each([0.5, 1, 1.6])('touches two borders of a picture of aspect %d, and lies between the others', (aspect) => {
    const slopes: Slopes = { across: SLOPE * aspect, upwards: SLOPE };
    for (const back of [new Vector3(0.3, 0.4, 1), new Vector3(-1, 0.1, 0.2), new Vector3(0, 1, 0.01)]) {
      const framed = frameShape(points, new Box3().setFromPoints(points), axesOf(back.normalize().negate()), slopes);
      const { x, y } = bounds(points, framed, aspect);
      for (const [low, high] of [x, y]) {
        expect(low).toBeGreaterThan(-1 - 1e-9);
        expect(high).toBeLessThan(1 + 1e-9);
      }
      const touches = [x, y].map(([low, high]) => Math.max(1 + low, 1 - high) < 1e-6);
      expect(touches).toContain(true);
    }
  });
});

it('is larger by its shape than by its box', () => {
  const points = SHAPES.cloud;
  const box = new Box3().setFromPoints(points);
  const axes = axesOf(new Vector3(-0.5, -0.3, -1).normalize());
  const [byShape, byBox] = [points, []].map((given) => frameShape(given, box, axes, { across: SLOPE, upwards: SLOPE }));
  expect(byShape.position.distanceTo(byShape.target)).toBeLessThan(byBox.position.distanceTo(byBox.target));
});

it('looks from somewhere even at a single point', () => {
  const point = new Vector3(5, 5, 5);
  const { position, target } = frameShape([point], new Box3(point, point), axesOf(new Vector3(0, 0, -1)), { across: 1, upwards: 1 });
  expect(target.equals(point)).toBe(true);
  expect(position.distanceTo(target)).toBe(1);
});

it('has all corners of a box', () => {
  const box = new Box3(new Vector3(-1, -2, -3), new Vector3(4, 5, 6));
  expect(new Box3().setFromPoints(cornersOf(box)).equals(box)).toBe(true);
});
