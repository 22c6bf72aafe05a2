// The shape-outline over a mesh.
import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments } from 'three';
import type { Outline } from '../hierarchy/outline.js';

const COLOUR = 0x2f7de1;

/// `place`: what the tiles' positions are relative to, itself relative to the origin.
export class OutlineObject extends LineSegments<BufferGeometry, LineBasicMaterial> {
  constructor({ positions, segments }: Outline, place: readonly [number, number, number]) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(positions, 3));
    geometry.setIndex(new BufferAttribute(segments, 1));
    super(geometry, new LineBasicMaterial({ color: COLOUR, depthTest: false, transparent: true, opacity: 0.8 }));
    this.position.set(-place[0], -place[1], -place[2]);
    this.renderOrder = 1;
    this.raycast = () => undefined;
  }

  dispose(): void {
    this.geometry.dispose();
    this.material.dispose();
    this.removeFromParent();
  }
}
