// SPDX-License-Identifier: MIT
import { Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { Placement, type Shown } from '../../src/plugins/placement.js';

const MODEL: Shown = { centre: new Vector3(100, 50, -7), size: 40, metresPerUnit: null, direction: null };

function inWorld(placement: Placement, x: number, y: number, z: number): number[] {
  return new Vector3(x, y, z).applyMatrix4(placement.toWorld).toArray();
}

describe('a model in the room', () => {
  it('stands in front, a metre large, whatever its unit', () => {
    const placement = new Placement(MODEL, true);
    expect(placement.unitsPerMetre).toBe(40);
    inWorld(placement, 0, 1.1, -1.3).forEach((value, axis) => { expect(value).toBeCloseTo(MODEL.centre.toArray()[axis], 9); });
    inWorld(placement, 0, 2.1, -1.3).forEach((value, axis) => { expect(value).toBeCloseTo([100, 90, -7][axis], 9); });
  });

  it('is as large as it is, if that is known and fits', () => {
    expect(new Placement({ ...MODEL, metresPerUnit: 0.01 }, true).unitsPerMetre).toBe(100);
    expect(new Placement({ ...MODEL, metresPerUnit: 1 }, true).unitsPerMetre).toBe(40);
    expect(new Placement({ ...MODEL, metresPerUnit: 1e-5 }, true).unitsPerMetre).toBe(40);
  });

  it('shows the side that is seen first', () => {
    const placement = new Placement({ ...MODEL, direction: [1, 0.2, 0] }, false);
    // From the visitor to the model goes against the direction.
    const [eye, centre] = [inWorld(placement, 0, 0, 0), inWorld(placement, 0, 0, -1.3)];
    expect(eye[0] - centre[0]).toBeCloseTo(1.3 * 40, 6);
    expect(eye[2] - centre[2]).toBeCloseTo(0, 6);
  });

  it('is moved, turned and resized around its centre', () => {
    const placement = new Placement(MODEL, false);
    placement.move(new Vector3(0.5, 0, 0.3));
    placement.turn(1);
    placement.resize(2);
    inWorld(placement, 0.5, 0, -1).forEach((value, axis) => { expect(value).toBeCloseTo(MODEL.centre.toArray()[axis], 9); });
    expect(placement.unitsPerMetre).toBe(20);
    placement.resize(1e9);
    expect(placement.unitsPerMetre).toBeCloseTo(40 / 1e3, 12);
    placement.resize(0);
    expect(placement.unitsPerMetre).toBeCloseTo(4000, 6);
  });
});
