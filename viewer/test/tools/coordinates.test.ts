// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { Coordinates, globePlace, type ModelPlace } from '../../src/tools/coordinates.js';
import { distanceOf, type Vector } from '../../src/tools/vectors.js';

const PLAIN: ModelPlace = { origin: [0, 0, 0], place: [0, 0, 0], up: 'y', transform: null };
const AXIS = 6378137;
const POLE = 6356752.314245179;

describe('the coordinates of the input', () => {
  it('are what is stored, bit for bit, where nothing is added: the sign of a zero too', () => {
    const point = new Coordinates(PLAIN).toInput([-0, 0.1, Math.fround(0.1)]);
    expect(Object.is(point[0], -0)).toBe(true);
    expect(point.slice(1)).toEqual([0.1, Math.fround(0.1)]);
  });

  it('are those of the origin and the lattice together, and lead back', () => {
    const coordinates = new Coordinates({ ...PLAIN, origin: [691000, 5335000, 0], place: [-8, 0, 16] });
    expect(coordinates.toInput([1.5, 2.25, -3])).toEqual([690993.5, 5335002.25, 13]);
    expect(coordinates.fromInput([690993.5, 5335002.25, 13])).toEqual([1.5, 2.25, -3]);
  });

});

describe('the place on the globe', () => {
  it('of the ends of its axes is known', () => {
    for (const [point, longitude, latitude, height] of [
      [[AXIS, 0, 0], 0, 0, 0], [[0, AXIS + 100, 0], 90, 0, 100], [[0, 0, POLE - 5], 0, 90, -5], [[0, 0, -POLE], 0, -90, 0],
    ] as [Vector, number, number, number][]) {
      const place = globePlace(point);
      expect(place.longitude).toBeCloseTo(longitude, 10);
      expect(place.latitude).toBeCloseTo(latitude, 10);
      expect(place.height).toBeCloseTo(height, 6);
    }
  });

  it('leads back to the point from anywhere', () => {
    for (const [longitude, latitude, height] of [[10.985, 47.421, 2962], [-122, -33.5, -400], [179, 89.9, 10], [1, 0.001, 9e5]]) {
      const place = globePlace(pointOf(longitude, latitude, height));
      expect(distanceOf(pointOf(place.longitude, place.latitude, place.height), pointOf(longitude, latitude, height))).toBeLessThan(1e-6);
      expect(place.height).toBeCloseTo(height, 6);
    }
  });

  it('is that of the transform, whose columns tell how long a unit is', () => {
    const transform = [0, 2, 0, 0, 0, 0, 2, 0, 2, 0, 0, 0, AXIS, 0, 0, 1]; // east, north, up
    const upZ = new Coordinates({ ...PLAIN, up: 'z', transform });
    expect(upZ.metresPerUnit).toBe(2);
    expect(upZ.toGlobe([0, 0, 25])?.height).toBeCloseTo(50, 6);
    expect(new Coordinates({ ...PLAIN, transform }).toGlobe([0, 25, 0])?.height).toBeCloseTo(50, 6);
    expect(new Coordinates(PLAIN).toGlobe([0, 0, 0])).toBeNull();
    expect(new Coordinates(PLAIN).metresPerUnit).toBeNull();
  });
});

function pointOf(longitude: number, latitude: number, height: number): Vector {
  const [l, b] = [longitude, latitude].map((degrees) => (degrees * Math.PI) / 180);
  const squared = 1 - (POLE / AXIS) ** 2;
  const normal = AXIS / Math.sqrt(1 - squared * Math.sin(b) ** 2);
  return [(normal + height) * Math.cos(b) * Math.cos(l), (normal + height) * Math.cos(b) * Math.sin(l), (normal * (1 - squared) + height) * Math.sin(b)];
}
