// SPDX-License-Identifier: MIT
import { Sphere } from 'three';
import type { HierarchyView } from '../scene/hierarchy_view.js';
import { ClippedPainter } from '../tools/caps.js';

/// Makes what draws a view cut open, wherever it stands.
export function cutPainter(view: HierarchyView): ClippedPainter {
  return new ClippedPainter(view, () => {
    const { center, radius } = view.box.clone().applyMatrix4(view.matrixWorld).getBoundingSphere(new Sphere());
    return { middle: center, reach: 1.1 * radius };
  }, undefined, (material) => { view.leaveOut(material); });
}
