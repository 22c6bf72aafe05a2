// SPDX-License-Identifier: MIT
import { Box3, Matrix4, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import type { Manifest } from '../../src/hierarchy/manifest.js';
import { alignedMatrix, groupMatrix, layingOf, tilesMatrix } from '../../src/pair/placing.js';
import { DEFAULT_STANDING, uprightRows, type Standing } from '../../src/scene/standing.js';
import { Coordinates } from '../../src/tools/coordinates.js';
import type { Vector } from '../../src/tools/vectors.js';

function manifestOf(change: Partial<Manifest>): Manifest {
  return { origin: [0, 0, 0], place: [0, 0, 0], up: 'y', units: null, transform: null, ...change } as Manifest;
}

/// A point of the input's coordinates, as it is seen in the world.
function inWorld(manifest: Manifest, standing: Standing, point: Vector, group = new Matrix4()): Vector3 {
  const rows = uprightRows(standing, manifest.up === 'z');
  const local = new Coordinates(manifest).fromInput(point);
  const upright = rows.map((row) => row[0] * local[0] + row[1] * local[1] + row[2] * local[2]);
  return new Vector3(...upright).applyMatrix4(group);
}

function expectAt(point: Vector3, other: Vector3, digits = 9): void {
  expect(point.distanceTo(other)).toBeLessThan(10 ** -digits);
}

function placed(first: Manifest, second: Manifest, standing = DEFAULT_STANDING): Matrix4 {
  return groupMatrix(first, second, layingOf(first, second, standing), standing, new Matrix4());
}

describe('a second model', () => {
  const point: Vector = [400_123.5, 5_000_321.25, 812];

  it('stands where its coordinates say, whatever the origins are', () => {
    const first = manifestOf({ origin: [400_000, 5_000_000, 0], up: 'z' });
    const second = manifestOf({ origin: [400_500, 5_000_250, 100], place: [0.5, 0, 0], up: 'z' });
    expectAt(inWorld(second, DEFAULT_STANDING, point, placed(first, second)), inWorld(first, DEFAULT_STANDING, point));
  });

  it('needs no move at all where both have one origin', () => {
    const both = manifestOf({ origin: [3, 4, 5] });
    expect(placed(both, both).elements.map((value) => value + 0)).toEqual(new Matrix4().elements);
  });

  it.each([{ up: 'file', stretch: 3 }, { up: 'z', stretch: 2 }, { up: '-x', stretch: 1 }] as const)('stands as the first one does: %j', (standing) => {
    const first = manifestOf({ origin: [1, 2, 3] });
    const second = manifestOf({ origin: [-4, 0, 9] });
    expectAt(inWorld(second, standing, [5, 6, 7], placed(first, second, standing)), inWorld(first, standing, [5, 6, 7]));
  });

  it('is upright where the files say different axes are up', () => {
    const [first, second] = [manifestOf({ up: 'y' }), manifestOf({ up: 'z', origin: [1, 1, 1] })];
    expect(layingOf(first, second, DEFAULT_STANDING).isTurned).toBe(true);
    expectAt(inWorld(second, DEFAULT_STANDING, [2, -5, 3], placed(first, second)), inWorld(first, DEFAULT_STANDING, [2, 3, 5]));
    const chosen: Standing = { up: 'y', stretch: 1 };
    expect(layingOf(first, second, chosen).isTurned).toBe(false);
    expectAt(inWorld(second, chosen, [2, 3, 5], placed(first, second, chosen)), inWorld(first, chosen, [2, 3, 5]));
  });

  it('is as large as its unit says', () => {
    const [first, second] = [manifestOf({ units: 'm' }), manifestOf({ units: 'mm', origin: [1000, 0, 0] })];
    expect(layingOf(first, second, DEFAULT_STANDING).factor).toBe(0.001);
    expectAt(inWorld(second, DEFAULT_STANDING, [1500, 250, 0], placed(first, second)), inWorld(first, DEFAULT_STANDING, [1.5, 0.25, 0]));
  });

  it('lies on the earth where both have a place there', () => {
    const turn = new Matrix4().makeRotationZ(0.3).setPosition(4e6, 6e5, 4.9e6);
    const beside = turn.clone().multiply(new Matrix4().makeTranslation(100, 20, 3));
    const first = manifestOf({ up: 'z', transform: turn.elements });
    const second = manifestOf({ up: 'y', transform: beside.elements });
    const laying = layingOf(first, second, DEFAULT_STANDING);
    expect(laying.by).toBe('earth');
    // y is up in the second one: (x, y, z) is (x, -z, y) on the earth.
    expectAt(inWorld(second, DEFAULT_STANDING, [1, 2, -5], placed(first, second)), inWorld(first, DEFAULT_STANDING, [101, 25, 5]), 6);
    expect(layingOf(first, { ...second, transform: null }, DEFAULT_STANDING).by).toBe('alone');
  });

  it('leads from its tiles to those of the first one', () => {
    const [first, second] = [manifestOf({ origin: [10, 0, 0] }), manifestOf({ origin: [4, 0, 0], place: [1, 0, 0] })];
    const matrix = tilesMatrix(first, second, layingOf(first, second, DEFAULT_STANDING));
    expect(new Vector3(7, 0, 0).applyMatrix4(matrix).toArray()).toEqual([2, 0, 0]);
  });
});

describe('boxes that are laid on each other', () => {
  const unit = new Box3(new Vector3(0, 0, 0), new Vector3(1, 1, 1));

  it('have one middle, and keep their sizes where these are alike', () => {
    const other = new Box3(new Vector3(100, 0, 0), new Vector3(102, 2, 2));
    const laid = other.clone().applyMatrix4(alignedMatrix(unit, other));
    expect(laid.getCenter(new Vector3()).toArray()).toEqual([0.5, 0.5, 0.5]);
    expect(laid.getSize(new Vector3()).x).toBe(2);
  });

  it('are made as large as each other where they are not', () => {
    const other = new Box3(new Vector3(1000, 0, 0), new Vector3(2000, 1000, 1000));
    expect(other.clone().applyMatrix4(alignedMatrix(unit, other)).getSize(new Vector3()).x).toBeCloseTo(1, 9);
  });
});
