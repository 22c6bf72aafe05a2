// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { DEFAULT_LOOK } from '../../src/scene/settings.js';
import { DEFAULT_STANDING } from '../../src/scene/standing.js';
import { writeLink } from '../../src/view/view_link.js';
import { DEFAULT_APPEARANCE as PLAIN, DEFAULT_LIGHT, keepStanding, readLight, readLook, readStanding, readStandings, viewOf, withChoices, type Appearance, type Standings } from '../../page/appearance.js';

const OTHER: Appearance = {
  look: { ...DEFAULT_LOOK, colours: 'height', texture: false, relight: true, cavities: false, shading: 'flat', wires: true, points: true, outline: true },
  light: { name: 'raking', key: [-1.25, 0.5], occlusion: true },
  standing: { up: '-x', stretch: 12 },
  level: 3,
};
const formatChoices = (appearance: Appearance): string => writeLink(viewOf(appearance));

describe('the choices of a link', () => {
  it('are none where nothing was chosen', () => {
    expect(formatChoices(PLAIN)).toBe('');
    expect(withChoices('', OTHER)).toEqual(OTHER);
  });

  it('come back, whatever the reader has chosen', () => {
    expect(withChoices(formatChoices(OTHER), PLAIN)).toEqual(OTHER);
    const one = { ...PLAIN, light: { name: 'flat', key: null, occlusion: false } as const };
    expect(formatChoices(one)).toBe('light=flat');
    expect(withChoices('light=flat', OTHER)).toEqual({ ...one, standing: OTHER.standing, level: OTHER.level });
  });

  it('of how it stands leave the look alone', () => {
    expect(withChoices('up=z', OTHER)).toEqual({ ...OTHER, standing: { up: 'z', stretch: 1 } });
  });

  it.each(['colours=pink', 'light=', 'light=moon,1,2', 'light=auto,1', 'light=auto,x,y', 'light=auto,1e9,0', 'up=up', 'stretch=0', 'stretch=1e9', 'stretch=x', 'texture', '&&==&'])(
    'are nothing where they are unsound: %s',
    (text) => { expect(withChoices(text, PLAIN)).toEqual(PLAIN); },
  );
});

describe('what the browser keeps', () => {
  it('is sound', () => {
    expect(readLight({ name: 'sun', key: [1, 2] })).toEqual({ name: 'sun', key: [1, 2], occlusion: false });
    expect(readLight({ name: 'moon', occlusion: true })).toEqual({ ...DEFAULT_LIGHT, occlusion: true });
    expect(readLight({ occlusion: 1 })).toEqual(DEFAULT_LIGHT);
    for (const key of [7, [1], [1, 'x'], [1, 2, 3], [NaN, 0], null]) expect(readLight({ name: 'sun', key })).toEqual({ name: 'sun', key: null, occlusion: false });
    expect(readLook({ colours: 'height', wires: true, ramp: 'jet', attribute: 7, hidden: ['x'], texture: 'on', material: 'matcap' })).toEqual({ ...DEFAULT_LOOK, colours: 'height', wires: true });
    expect(readStanding({ up: 'q', stretch: 'x' })).toEqual(DEFAULT_STANDING);
    expect(readStandings({ a: { up: 'z', stretch: 2 }, b: 7 })).toEqual({ a: { up: 'z', stretch: 2 }, b: DEFAULT_STANDING });
  });

  it('of how models stand is the last hundred, without those that stand as they are', () => {
    let standings: Standings = {};
    for (let i = 0; i < 150; ++i) standings = keepStanding(standings, `m${i}`, { up: 'z', stretch: 1 });
    expect(Object.keys(standings)).toHaveLength(100);
    expect(standings.m149).toEqual({ up: 'z', stretch: 1 });
    standings = keepStanding(standings, 'm149', DEFAULT_STANDING);
    expect(standings.m149).toBeUndefined();
    standings = keepStanding(standings, 'm100', { up: 'x', stretch: 1 });
    expect(Object.keys(standings).at(-1)).toBe('m100');
  });
});
