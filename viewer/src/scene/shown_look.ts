// SPDX-License-Identifier: MIT
// How a model is shown where that was left open: by what it is.
import type { LightName } from '../view/view_table.js';
import type { Rig } from './lighting.js';
import type { Look } from './settings.js';
import type { Terrain } from './terrain.js';

/// Slopes that show well: those of hills are shaded so steep.
const SHOWN_SLOPE = 0.5;
const MOST_RELIEF = 1000;

/// Facts about a model; null: not known yet, or it has none.
export interface KnownModel {
  readonly terrain: Terrain | null;
  readonly hasColours: boolean | null;
  readonly hasTriangles: boolean | null;
  readonly hasAttributes: boolean | null;
}

/// The sun over terrains, a studio around all else.
export function rigFor({ terrain }: KnownModel): Rig {
  return terrain?.upright === true ? 'sun' : 'studio';
}

/// The lamps of a light by its name, and the surface that it shows.
export function rigOf(name: LightName, model: KnownModel): Rig {
  if (name === 'matcap' || name === 'relief') return 'studio';
  return name === 'auto' ? rigFor(model) : name;
}

export function materialOf(name: LightName): Look['material'] {
  return name === 'matcap' || name === 'relief' ? name : 'lit';
}

function reliefOf({ slope }: Terrain, stretch: number): number {
  return Math.min(Math.max(SHOWN_SLOPE / Math.max(slope * stretch, 1e-9), 1), MOST_RELIEF);
}

/// A model without colours of its own is plain: white shows no form. But terrains are coloured by height, and under the sun, or seen from their front, their
/// slopes are shaded steeper. `stretch`: heights are shown so many times as high.
export function shownLook(look: Look, rig: Rig, stretch: number, { terrain, hasColours, hasTriangles, hasAttributes }: KnownModel): Look {
  const wished = look.colours === 'attribute' && hasAttributes === false ? 'vertex' : look.colours;
  const colours = wished === 'vertex' && hasColours === false ? (terrain === null ? 'plain' : 'height') : wished;
  const isSteep = terrain !== null && (rig === 'sun' || !terrain.upright);
  const relief = isSteep ? reliefOf(terrain, terrain.upright ? stretch : 1) : 1;
  const points = look.points || hasTriangles === false; // nothing else shows those
  return { ...look, colours, points, relief };
}
