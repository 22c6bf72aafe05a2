// SPDX-License-Identifier: MIT
// How a model is shown: its colours and surface, its light, how it stands, its levels; from views, and as the browser keeps it.
import { asObject, type Json } from '../src/json_value.js';
import { DEFAULT_LOOK, type Look } from '../src/scene/settings.js';
import { DEFAULT_STANDING, type Standing } from '../src/scene/standing.js';
import { lookOf, standingOf } from '../src/view/view_look.js';
import { partsOf, readLink } from '../src/view/view_link.js';
import { storedValue } from '../src/view/view_json.js';
import { keysOf, type LightChoice, type View, type ViewKey } from '../src/view/view_table.js';

export { COLOURS, LIGHTS, type LightName } from '../src/view/view_table.js';

export interface Light extends LightChoice {
  /// Hollows of what is seen get less of it.
  readonly occlusion: boolean;
}

export interface Appearance {
  look: Look;
  light: Light;
  standing: Standing;
  /// The finest level that is shown; null: all.
  level: number | null;
}

export const DEFAULT_LIGHT: Light = { name: 'auto', key: null, occlusion: false };

export function oneOf<T, Otherwise>(value: unknown, choices: readonly T[], otherwise: Otherwise): T | Otherwise {
  return choices.find((choice) => choice === value) ?? otherwise;
}

/// What a view says of these, on top of what is given; one that says anything of look and light says all of it.
export function withChoices(link: string, given: Appearance): Appearance {
  const [view, parts] = [readLink(link), partsOf(link)];
  return {
    ...(parts.has('look') ? { look: lookOf(view), light: lightOf(view) } : { look: given.look, light: given.light }),
    standing: parts.has('standing') ? standingOf(view) : given.standing,
    level: parts.has('level') ? (view.level ?? null) : given.level,
  };
}

function lightOf({ light, occlusion }: View): Light {
  return { ...DEFAULT_LIGHT, ...light, occlusion: occlusion ?? DEFAULT_LIGHT.occlusion };
}

export function viewOf({ look, light: { name, key, occlusion }, standing, level }: Appearance): View {
  const { attribute, range, tolerance } = look;
  const unsaid = { attribute: attribute === '' ? undefined : attribute, range: range ?? undefined, tolerance: tolerance ?? undefined };
  return { ...look, ...unsaid, light: { name, key }, occlusion, ...standing, level: level ?? undefined };
}

// ---- kept in the browser

/// Returns the part of a look that holds for other models too.
export function lastingLook(look: Partial<Look>): Partial<Look> {
  return Object.fromEntries(Object.entries(look).filter(([name]) => !['attribute', 'range', 'tolerance', 'hidden'].includes(name)));
}

function storedView(keys: readonly ViewKey[], stored: Json): View {
  return Object.fromEntries(keys.map((key) => [key, storedValue(key, stored[key]) ?? undefined]));
}

export function readLook(stored: unknown): Look {
  return lookOf(storedView(keysOf('look'), asObject(stored)));
}

/// A name alone, and the key beside it.
export function readLight(stored: unknown): Light {
  const { name, key, occlusion } = asObject(stored);
  const angles: unknown[] = Array.isArray(key) ? key : [];
  const light = storedValue('light', name);
  const turned = light && storedValue('light', [light.name, ...angles].join());
  return { ...DEFAULT_LIGHT, ...(turned ?? light), occlusion: occlusion === true };
}

export function readStanding(stored: unknown): Standing {
  return standingOf(storedView(keysOf('standing'), asObject(stored)));
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

export const DEFAULT_APPEARANCE: Appearance = { look: DEFAULT_LOOK, light: DEFAULT_LIGHT, standing: DEFAULT_STANDING, level: null };
