// SPDX-License-Identifier: MIT
// The shape-outline over a mesh.
import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments } from 'three';
import type { Outline } from '../hierarchy/outline.js';

const COLOUR = 0x2f7de1;
const STRONG = 0.8;
const BESIDE_FORM = 0.35;

/// `place`: what the tiles' positions are relative to, itself relative to the origin.
export class OutlineObject extends LineSegments<BufferGeometry, LineBasicMaterial[]> {
  constructor({ positions, segments, formSegments }: Outline, place: readonly [number, number, number]) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(positions, 3));
    geometry.setIndex(new BufferAttribute(segments, 1));
    const formBegin = segments.length - 2 * formSegments;
    geometry.addGroup(0, formBegin, 0);
    geometry.addGroup(formBegin, 2 * formSegments, 1);
    super(geometry, [formSegments > 0 ? BESIDE_FORM : STRONG, STRONG].map((opacity) => new LineBasicMaterial({ color: COLOUR, depthTest: false, transparent: true, opacity })));
    this.position.set(-place[0], -place[1], -place[2]);
    this.renderOrder = 1;
    this.raycast = () => undefined;
  }

  dispose(): void {
    this.geometry.dispose();
    for (const material of this.material) material.dispose();
    this.removeFromParent();
  }
}
