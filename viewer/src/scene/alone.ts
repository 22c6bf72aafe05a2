// SPDX-License-Identifier: MIT
// Draws the surface of a model and nothing else of a scene, as passes do that look for its triangles alone.
import type { Object3D, Scene } from 'three';

/// Parts that only decorate the surface do not count.
function isSurface(object: Object3D): boolean {
  return 'isMesh' in object || !('isLine' in object || 'isPoints' in object);
}

function othersIn(scene: Scene, model: Object3D): Object3D[] {
  const within = new Set<Object3D>();
  model.traverse((object) => within.add(object));
  const others: Object3D[] = [];
  scene.traverseVisible((object) => {
    const isDrawn = 'isMesh' in object || 'isLine' in object || 'isPoints' in object || 'isSprite' in object;
    if (isDrawn && !(within.has(object) && isSurface(object))) others.push(object);
  });
  return others;
}

/// Calls `draw` while the scene shows the surface of `model` alone, without a background.
export function alone(scene: Scene, model: Object3D, draw: () => void): void {
  const hidden = othersIn(scene, model);
  const { overrideMaterial, background } = scene;
  for (const object of hidden) object.visible = false;
  scene.background = null;
  try {
    draw();
  } finally {
    Object.assign(scene, { overrideMaterial, background });
    for (const object of hidden) object.visible = true;
  }
}
