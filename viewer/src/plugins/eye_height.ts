// SPDX-License-Identifier: MIT
// How tall somebody is who walks in a model.
import { Vector3 } from 'three';
import type { HierarchyView } from '../scene/hierarchy_view.js';
import { storeysOf } from '../tools/storeys.js';
import { UNITS, unitOfModel } from '../tools/units.js';

export const EYE_METRES = 1.6;
const EYE_OF_ROOM = 0.64; // of its height
const EYE_OF_MODEL = 0.02; // of its diagonal, where nothing is known
const MOST_OF_MODEL = 0.25; // of its longest side: then the unit is wrong, or the model is a toy

/// Units of the world from the feet to the eyes: 1.6 m where the unit is known, else of the height of rooms, else of the model.
export function usualEyes(view: HierarchyView): number {
  const size = view.box.getSize(new Vector3());
  const usual = knownEyes(view);
  return usual !== null && usual < MOST_OF_MODEL * Math.max(size.x, size.y, size.z) ? usual : EYE_OF_MODEL * size.length() || 1;
}

/// Null: neither the unit nor the height of rooms is known.
function knownEyes({ manifest, root, upwards, standing }: HierarchyView): number | null {
  const unit = manifest && unitOfModel(manifest);
  const metres = unit === null ? null : UNITS[unit].metres;
  if (metres !== null) return EYE_METRES / metres;
  const storeys = root === null ? [] : storeysOf(root, upwards);
  if (storeys.length === 0) return null;
  const heights = storeys.map(({ floor, ceiling }) => ceiling - floor).sort((a, b) => a - b);
  return EYE_OF_ROOM * standing.stretch * heights[Math.floor(heights.length / 2)];
}
