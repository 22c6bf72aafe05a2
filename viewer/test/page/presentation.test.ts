// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { DEFAULT_APPEARANCE as PLAIN, LIGHTS, type Light } from '../../page/appearance.js';
import { keyOf, turned } from '../../src/scene/lighting.js';
import { nextLight, shownOf } from '../../page/view/presentation.js';
import { DEFAULT_LOOK } from '../../src/scene/settings.js';

const HILLS = { terrain: { along: [0, 1, 0] as const, upright: true, low: 0, high: 10, slope: 0.05 }, hasColours: false, hasTriangles: true, hasAttributes: false };
const SHEET = { ...HILLS, terrain: { ...HILLS.terrain, along: [0, 0, 1] as const, upright: false } };
const FORM = { terrain: null, hasColours: false, hasTriangles: true, hasAttributes: false };

describe('what is shown', () => {
  it('is a terrain by height and under the sun, with slopes that show', () => {
    expect(shownOf(PLAIN, HILLS)).toMatchObject({ look: { colours: 'height', relief: 10, material: 'lit' }, rig: 'sun', key: keyOf('sun') });
  });

  it('is a sheet on its side by height and in a studio, with slopes that show', () => {
    expect(shownOf({ ...PLAIN, standing: { up: 'file', stretch: 5 } }, SHEET)).toMatchObject({ look: { colours: 'height', relief: 10 }, rig: 'studio' });
  });

  it('keeps the colours of a terrain that has some, and those that were chosen', () => {
    expect(shownOf(PLAIN, { ...HILLS, hasColours: true }).look.colours).toBe('vertex');
    expect(shownOf({ ...PLAIN, look: { ...DEFAULT_LOOK, colours: 'plain' } }, HILLS).look.colours).toBe('plain');
  });

  it('counts heights that are stretched already', () => {
    const relief = (stretch: number): number => shownOf({ ...PLAIN, standing: { up: 'file', stretch } }, HILLS).look.relief;
    expect(relief(5)).toBe(2);
    expect(relief(50)).toBe(1);
  });

  it('is any other form as it is, in a studio', () => {
    expect(shownOf(PLAIN, { ...FORM, hasColours: true })).toEqual({ look: DEFAULT_LOOK, rig: 'studio', key: keyOf('studio') });
    expect(shownOf(PLAIN, { ...FORM, hasColours: null }).look.colours).toBe('vertex');
  });

  it('is the points of a mesh without triangles', () => {
    expect(shownOf(PLAIN, { ...FORM, hasTriangles: false, hasAttributes: false }).look.points).toBe(true);
    expect(shownOf(PLAIN, FORM).look.points).toBe(false);
  });

  it('is plain where the input says no colour: white would hide the form', () => {
    expect(shownOf(PLAIN, FORM).look.colours).toBe('plain');
  });

  it.each<[Light, object]>([
    [{ name: 'studio', key: null, occlusion: false }, { rig: 'studio', look: { relief: 1 } }],
    [{ name: 'relief', key: null, occlusion: false }, { rig: 'studio', look: { material: 'relief', relief: 1 } }],
    [{ name: 'matcap', key: null, occlusion: false }, { look: { material: 'matcap', relief: 1 } }],
    [{ name: 'auto', key: [0.1, 0.2], occlusion: false }, { rig: 'sun', key: { right: 0.1, up: 0.2 } }],
  ])('follows the light that was chosen: %j', (light, shown) => {
    expect(shownOf({ ...PLAIN, light }, HILLS)).toMatchObject(shown);
  });
});

describe('the light', () => {
  it('comes around to the first', () => {
    let light: Light = { name: 'auto', key: [1, 1], occlusion: false };
    const names = LIGHTS.map(() => (light = nextLight(light)).name);
    expect(names).toEqual([...LIGHTS.slice(1), 'auto']);
    expect(light.key).toBeNull();
  });

  it('is turned no further than to where it is of use', () => {
    expect(turned({ right: 1, up: 1 }, { right: 0.5, up: -3 })).toEqual({ right: 1.5, up: -1.5 });
    expect(turned({ right: 3, up: 0 }, { right: 9, up: 0 }).right).toBe(Math.PI);
  });
});
