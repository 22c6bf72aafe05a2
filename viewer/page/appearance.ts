// SPDX-License-Identifier: MIT
// How a model is shown: its colours and surface, its light, how it stands; and what a link and the browser keep of it.
import { asObject, type Json } from '../src/json_value.js';
import { RAMPS } from '../src/scene/ramps.js';
import { DEFAULT_LOOK, type Colours, type Look } from '../src/scene/settings.js';
import { DEFAULT_STANDING, MOST_STRETCH, UPS, type Standing } from '../src/scene/standing.js';

/// `auto`: the sun over terrains, a studio around all else. `matcap`: no light, the form alone. `relief`: scratches stand out.
export type LightName = 'auto' | 'studio' | 'raking' | 'relief' | 'flat' | 'sun' | 'matcap';

export interface Light {
  name: LightName;
  /// Where the key light comes from instead, radians to the right and up; null: as the name says.
  key: readonly [number, number] | null;
  /// Hollows of what is seen get less of it.
  occlusion: boolean;
}

export interface Appearance {
  look: Look;
  light: Light;
  standing: Standing;
}

export const LIGHTS: readonly LightName[] = ['auto', 'studio', 'raking', 'relief', 'flat', 'sun', 'matcap'];
export const COLOURS: readonly Colours[] = ['plain', 'vertex', 'partition', 'error', 'height', 'attribute'];
export const DEFAULT_LIGHT: Light = { name: 'auto', key: null, occlusion: false };

const SWITCHES = ['texture', 'relight', 'cavities', 'wires', 'points', 'outline', 'isolines'] as const;
type Switches = Pick<Look, (typeof SWITCHES)[number]>;

export function oneOf<T, Otherwise>(value: unknown, choices: readonly T[], otherwise: Otherwise): T | Otherwise {
  return choices.find((choice) => choice === value) ?? otherwise;
}

// ---- kept in the browser

const LONGEST_NAME = 100; // of an attribute
const MOST_HIDDEN = 256; // labels

function readNumbers(stored: unknown): number[] {
  const given: unknown[] = Array.isArray(stored) ? stored : [];
  return given.filter((value): value is number => typeof value === 'number' && Number.isFinite(value));
}

function readRange(stored: unknown): Look['range'] {
  const numbers = readNumbers(stored);
  return numbers.length === 2 ? [numbers[0], numbers[1]] : null;
}

/// Returns the part of a look that holds for other models too.
export function lastingLook(look: Partial<Look>): Partial<Look> {
  return Object.fromEntries(Object.entries(look).filter(([name]) => !['attribute', 'range', 'hidden'].includes(name)));
}

/// A switch that is neither on nor off is as it is without a choice.
function readSwitches(valueOf: (name: string) => unknown): Switches {
  return Object.fromEntries(SWITCHES.map((name) => [name, oneOf(valueOf(name), [true, false], DEFAULT_LOOK[name])])) as unknown as Switches;
}

/// `relief` follows from the rest.
export function readLook(stored: unknown): Look {
  const look = asObject(stored);
  return {
    colours: oneOf(look.colours, COLOURS, DEFAULT_LOOK.colours),
    ...readSwitches((name) => look[name]),
    material: DEFAULT_LOOK.material,
    relief: DEFAULT_LOOK.relief,
    shading: oneOf(look.shading, ['smooth', 'flat'], DEFAULT_LOOK.shading),
    attribute: typeof look.attribute === 'string' ? look.attribute.slice(0, LONGEST_NAME) : '',
    ramp: oneOf(look.ramp, RAMPS, DEFAULT_LOOK.ramp),
    range: readRange(look.range),
    hidden: readNumbers(look.hidden).slice(0, MOST_HIDDEN),
  };
}

function readKey(stored: unknown): Light['key'] {
  if (!Array.isArray(stored) || stored.length !== 2) return null;
  const [right, up] = stored as unknown[];
  return isAngle(right) && isAngle(up) ? [right, up] : null;
}

function isAngle(value: unknown): value is number {
  return typeof value === 'number' && Math.abs(value) <= Math.PI;
}

export function readLight(stored: unknown): Light {
  const { name, key, occlusion } = asObject(stored);
  const known = oneOf(name, LIGHTS, null);
  return { ...(known === null ? DEFAULT_LIGHT : { name: known, key: readKey(key) }), occlusion: occlusion === true };
}

export function readStanding(stored: unknown): Standing {
  const { up, stretch } = asObject(stored);
  const isStretch = typeof stretch === 'number' && stretch >= 1 && stretch <= MOST_STRETCH;
  return { up: oneOf(up, UPS, DEFAULT_STANDING.up), stretch: isStretch ? stretch : DEFAULT_STANDING.stretch };
}

/// How models stand that do not stand as their files say, by their addresses; the last chosen last.
export type Standings = Record<string, Standing>;

const MOST_STANDINGS = 100;

export function readStandings(stored: unknown): Standings {
  const entries = Object.entries(asObject(stored)).slice(-MOST_STANDINGS);
  return Object.fromEntries(entries.map(([url, standing]) => [url, readStanding(standing)]));
}

export function keepStanding(standings: Standings, url: string, standing: Standing): Standings {
  const others = Object.entries(standings).filter(([each]) => each !== url);
  const isDefault = standing.up === DEFAULT_STANDING.up && standing.stretch === DEFAULT_STANDING.stretch;
  return Object.fromEntries([...others, ...(isDefault ? [] : [[url, standing] as const])].slice(-MOST_STANDINGS));
}

// ---- in links

const DIGITS = 4;

function onOff(is: boolean): string {
  return is ? 'on' : 'off';
}

function formatLight({ name, key }: Pick<Light, 'name' | 'key'>): string {
  return [name, ...(key ?? []).map((angle) => String(Number(angle.toPrecision(DIGITS))))].join(',');
}

function parseLight(text: string, occlusion: boolean): Light {
  const [name, ...key] = text.split(',');
  return readLight({ name, key: key.map(Number), occlusion });
}

/// `name=value` of all that is not as it is without a choice, with & between.
export function formatChoices({ look, light, standing }: Appearance): string {
  const choices: string[] = [];
  const add = (name: string, value: string, otherwise: string): void => { if (value !== otherwise) choices.push(`${name}=${value}`); };
  add('colours', look.colours, DEFAULT_LOOK.colours);
  add('shading', look.shading, DEFAULT_LOOK.shading);
  add('attribute', encodeURIComponent(look.attribute), '');
  add('ramp', look.ramp, DEFAULT_LOOK.ramp);
  add('range', look.range?.join(',') ?? '', '');
  add('hidden', look.hidden.join(','), '');
  for (const name of SWITCHES) add(name, onOff(look[name]), onOff(DEFAULT_LOOK[name]));
  add('light', formatLight(light), formatLight(DEFAULT_LIGHT));
  add('occlusion', onOff(light.occlusion), onOff(DEFAULT_LIGHT.occlusion));
  add('up', standing.up, DEFAULT_STANDING.up);
  add('stretch', String(standing.stretch), String(DEFAULT_STANDING.stretch));
  return choices.join('&');
}

function listed(text: string | null): number[] {
  return text === null || text === '' ? [] : text.split(',').map(Number);
}

function attributeChoices(choices: URLSearchParams): Json {
  return { attribute: choices.get('attribute'), ramp: choices.get('ramp'), range: listed(choices.get('range')), hidden: listed(choices.get('hidden')) };
}

/// Returns what a link chooses, on top of what is given; a link that chooses anything of look and light chooses all of it.
export function withChoices(text: string, given: Appearance): Appearance {
  const choices = new URLSearchParams(text);
  const standing = { ...given.standing, ...(choices.has('up') || choices.has('stretch') ? readStanding({ up: choices.get('up'), stretch: Number(choices.get('stretch') ?? 1) }) : {}) };
  if (!['colours', 'shading', 'light', 'occlusion', 'attribute', 'ramp', 'range', 'hidden', ...SWITCHES].some((name) => choices.has(name))) return { ...given, standing };
  const switches = Object.fromEntries(SWITCHES.map((name) => [name, oneOf(choices.get(name), ['on', 'off'], onOff(DEFAULT_LOOK[name])) === 'on']));
  const look = readLook({ ...switches, colours: choices.get('colours'), shading: choices.get('shading'), ...attributeChoices(choices) });
  return { look, light: parseLight(choices.get('light') ?? DEFAULT_LIGHT.name, choices.get('occlusion') === 'on'), standing };
}
