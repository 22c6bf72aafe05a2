// SPDX-License-Identifier: MIT
import { PerspectiveCamera, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { cubeTransform, positionFor, SIDES, type Side } from '../../src/tools/orientation.js';
import { Turntable } from '../../src/tools/turntable.js';
import { distanceOf, dot, subtract, unit } from '../../src/tools/vectors.js';

describe('the orientation cube', () => {
  it.each(Object.keys(SIDES) as Side[])('shows the %s from there, as far away', (side) => {
    const position = positionFor(side, [1, 2, 3], 5);
    expect(distanceOf(position, [1, 2, 3])).toBeCloseTo(5, 12);
    expect(dot(unit(subtract(position, [1, 2, 3])), SIDES[side])).toBeGreaterThan(0.9999);
  });

  it('turns against the camera: the side that it stands at is in front', () => {
    for (const side of Object.keys(SIDES) as Side[]) {
      const camera = new PerspectiveCamera();
      camera.position.set(...positionFor(side, [0, 0, 0], 3));
      camera.lookAt(0, 0, 0);
      camera.updateMatrixWorld();
      const numbers = cubeTransform(camera.matrixWorldInverse.elements).slice(9, -1).split(',').map(Number);
      const [x, y, z] = SIDES[side];
      const face = new Vector3(x, -y, z); // in CSS
      const seen = [0, 1, 2].map((row) => numbers[row] * face.x + numbers[4 + row] * face.y + numbers[8 + row] * face.z);
      expect(seen[2]).toBeGreaterThan(0.999); // towards the eye
    }
  });

  it('has its upper side above, as CSS counts', () => {
    const camera = new PerspectiveCamera();
    camera.position.set(0, 1, 1);
    camera.lookAt(0, 0, 0);
    camera.updateMatrixWorld();
    const numbers = cubeTransform(camera.matrixWorldInverse.elements).slice(9, -1).split(',').map(Number);
    expect(-numbers[5]).toBeLessThan(0); // the face at -y moves along -y
    expect(numbers.slice(12)).toEqual([0, 0, 0, 1]);
  });
});

describe('the turntable', () => {
  it('turns with time, and not while it is off', () => {
    const table = new Turntable();
    expect([table.isOn, table.take(50)]).toEqual([false, 0]);
    table.start(1000);
    const first = table.take(1050);
    expect(first).toBeGreaterThan(0);
    expect(table.take(1100)).toBeCloseTo(first, 12);
    expect(table.take(9000)).toBeCloseTo(2 * first, 12); // the page slept
    expect(table.take(8000)).toBe(0);
    table.stop();
    expect(table.take(9000)).toBe(0);
  });
});
