// SPDX-License-Identifier: MIT
// Keeps in the browser what the user chose. Whatever is stored there, what comes out is sound.
import { asObject, type Json } from '../src/json_value.js';
import { changedSettings, type Look, type Settings } from '../src/scene/settings.js';
import { oneOf, readLight, readLook, readStandings, type Light, type Standings } from './appearance.js';
import { LANGUAGES, type Language } from './words/languages.js';

/// Models may be shown in these orders. `folder`: in groups by folder, in each by name.
export const ORDERS = ['folder', 'name', 'newest', 'size', 'triangles'] as const;
export type Order = (typeof ORDERS)[number];

export type Theme = 'auto' | 'light' | 'dark';

export interface Preferences {
  theme: Theme;
  /// Null: as the browser wants it.
  language: Language | null;
  /// The gallery's.
  order: Order;
  panel: boolean;
  settings: Settings;
  look: Look;
  light: Light;
  standings: Standings;
}

export const THEMES: readonly Theme[] = ['auto', 'light', 'dark'];

/// Bytes of a MB, as the memory budget is counted.
export const MEGABYTE = 1e6;

export interface Range {
  least: number;
  most: number;
  step: number;
}

/// Numbers from these ranges may be chosen; the memory budget in MB.
export const RANGES = {
  framesPerSecond: { least: 5, most: 120, step: 5 },
  threshold: { least: 0.5, most: 16, step: 0.5 },
  memoryBudget: { least: 32, most: 4096, step: 32 },
} as const satisfies Record<string, Range>;

const KEY = 'meshhier';

function within(value: unknown, { least, most }: Range, otherwise: number): number {
  return typeof value === 'number' && value >= least && value <= most ? value : otherwise;
}

/// Tells whether the browser was told to fetch little.
function savesData(): boolean {
  return (globalThis.navigator as { connection?: { saveData?: boolean } } | undefined)?.connection?.saveData === true;
}

function readSettings(stored: Json): Settings {
  const defaults = changedSettings({});
  const budget = typeof stored.memoryBudget === 'number' ? stored.memoryBudget / MEGABYTE : null;
  return {
    framesPerSecond: within(stored.framesPerSecond, RANGES.framesPerSecond, defaults.framesPerSecond),
    threshold: within(stored.threshold, RANGES.threshold, defaults.threshold),
    restDetail: oneOf(stored.restDetail, [1, defaults.restDetail], savesData() ? 1 : defaults.restDetail),
    memoryBudget: within(budget, RANGES.memoryBudget, defaults.memoryBudget / MEGABYTE) * MEGABYTE,
  };
}

/// The preferences in a stored text, with defaults for whatever is missing or unsound.
export function parsePreferences(text: string | null): Preferences {
  let stored: Json = {};
  try {
    stored = asObject(JSON.parse(text ?? '{}'));
  } catch {
    // what cannot be read is as good as nothing
  }
  return {
    theme: oneOf(stored.theme, THEMES, 'auto'),
    language: oneOf(stored.language, LANGUAGES, null),
    order: oneOf(stored.order, ORDERS, 'folder'),
    panel: stored.panel === true,
    settings: readSettings(asObject(stored.settings)),
    look: readLook(stored.look),
    light: readLight(stored.light),
    standings: readStandings(stored.standings),
  };
}

export function loadPreferences(): Preferences {
  try {
    return parsePreferences(localStorage.getItem(KEY));
  } catch {
    return parsePreferences(null); // the browser keeps nothing
  }
}

export function savePreferences(preferences: Preferences): void {
  try {
    localStorage.setItem(KEY, JSON.stringify(preferences));
  } catch {
    // the browser keeps nothing: they hold until the page is left
  }
}
