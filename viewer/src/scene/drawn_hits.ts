// SPDX-License-Identifier: MIT
import type { Intersection, Raycaster } from 'three';
import { valuesAt } from '../tools/values_at.js';
import type { HierarchyView } from './hierarchy_view.js';
import { TileObject } from './tile_object.js';

/// The nearest hit of what is drawn of a view; null: there is none.
export function drawnHit(raycaster: Raycaster, view: HierarchyView): Intersection | null {
  const valuesOf = ({ object, face }: Intersection): number[] => (object instanceof TileObject && face ? valuesAt(object.drawn().tile, face.a) : []);
  return raycaster.intersectObject(view, true).find((hit) => view.plugins.keeps(hit.point, valuesOf(hit))) ?? null;
}
