// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { PROFILE_AXES, profileCsv, profileLines, profileOf } from '../../src/tools/profile.js';
import { sectionSvg } from '../../src/tools/section_svg.js';
import type { Vector } from '../../src/tools/vectors.js';
import { cube, drawnTile } from '../support/drawn.js';

const UP: Vector = [0, 1, 0];

/// A roof: y is 3 less the distance to its ridge, at x = 0, from -3 to 3; z from 0 to 4.
const roof = drawnTile([-3, 0, 0, 0, 3, 0, 3, 0, 0, -3, 0, 4, 0, 3, 4, 3, 0, 4], [0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4]);

describe('a profile', () => {
  it('has the heights along a line, from its first point to its last', () => {
    const [profile, ...others] = profileOf([roof], [[-2, 9, 1], [1, -4, 1]], UP);
    expect(others).toHaveLength(0);
    expect(profile[0]).toMatchObject({ distance: 0, point: [-2, 1, 1] });
    const last = profile[profile.length - 1];
    expect(last.distance).toBeCloseTo(3, 12);
    expect(last.point[1]).toBeCloseTo(2, 12);
    for (const { distance, point } of profile) {
      expect(point[1]).toBeCloseTo(3 - Math.abs(distance - 2), 12);
      expect(point[2]).toBeCloseTo(1, 12);
    }
    expect(profile.some(({ distance }) => Math.abs(distance - 2) < 1e-12)).toBe(true);
  });

  it('goes on around corners, and leaves out parts without a plan', () => {
    const profiles = profileOf([roof], [[-2, 0, 1], [-1, 0, 1], [-1, 5, 1], [-1, 5, 3]], UP);
    expect(profiles.map((profile) => [profile[0].distance, profile[profile.length - 1].distance])).toEqual([[0, 1], [1, 3]]);
    for (const { point } of profiles[1]) expect(point[1]).toBeCloseTo(2, 12);
  });

  it('of a closed surface has its upper and its lower side, and both walls where it ends within', () => {
    const inside = profileOf([cube()], [[0.5, 0, 0.25], [1.5, 0, 0.25]], UP);
    expect(inside.map((profile) => profile[0].point[1]).sort()).toEqual([0, 2]);
    const through = profileOf([cube()], [[-5, 0, 0.25], [5, 0, 0.25]], UP);
    const heights = through.flat().map(({ point }) => point[1]);
    expect([Math.min(...heights), Math.max(...heights)]).toEqual([0, 2]);
    expect(through.flat().every(({ distance }) => distance >= 5 && distance <= 7)).toBe(true);
  });

  it('is nothing beside the model, and of a single point', () => {
    expect(profileOf([roof], [[-9, 0, 1], [-8, 0, 1]], UP)).toEqual([]);
    expect(profileOf([roof], [[0, 0, 1]], UP)).toEqual([]);
  });

  it('is told in the coordinates of the input, as a table and as a drawing in true size', () => {
    const toInput = ([x, y, z]: Vector): Vector => [x + 100, y + 50, z];
    const profiles = profileOf([roof], [[-2, 0, 1], [0, 0, 1]], UP);
    const rows = profileCsv(profiles, toInput, UP).split('\r\n');
    expect(rows[0]).toBe('profile,distance,height,x,y,z');
    expect(rows[1]).toBe('1,0,51,98,51,1');
    expect(rows[rows.length - 2]).toBe('1,2,53,100,53,1');
    expect(rows[rows.length - 1]).toBe('');
    const svg = sectionSvg(profileLines(profiles, toInput, UP), { axes: PROFILE_AXES, unit: 'm', title: 'roof' });
    expect(svg).toContain('width="2000mm" height="2000mm"');
  });
});
