// SPDX-License-Identifier: MIT
// What a view says of the library's own choices: look and standing.
import { DEFAULT_LOOK, type Look } from '../scene/settings.js';
import type { Standing } from '../scene/standing.js';
import { keysOf, valueOf, type View } from './view_table.js';

const LOOK_KEYS = keysOf('look').filter((key) => Object.hasOwn(DEFAULT_LOOK, key));

/// All of it; `material` and `relief` follow from the light, and from what the model is.
export function lookOf(view: View): Look {
  return { ...DEFAULT_LOOK, ...Object.fromEntries(LOOK_KEYS.map((key) => [key, valueOf(view, key)])), attribute: view.attribute ?? DEFAULT_LOOK.attribute };
}

export function standingOf(view: View): Standing {
  return { up: valueOf(view, 'up')!, stretch: valueOf(view, 'stretch')! };
}
