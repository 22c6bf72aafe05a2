// SPDX-License-Identifier: MIT
// The orientation cube: it turns with the model, and its faces can be clicked.
import { cubeTransform, positionFor, SIDES, type Side } from '../../src/tools/orientation.js';
import { element } from '../parts/element.js';
import { CameraPose } from '../../src/scene/camera_pose.js';
import type { PageStage } from '../view/page_stage.js';
import { words } from './words/words.js';

export class Cube {
  readonly root: HTMLElement;
  private readonly body: HTMLElement;

  constructor(private readonly bench: PageStage) {
    const faces = (Object.keys(SIDES) as Side[]).map((side) => {
      const face = element('button', { type: 'button', class: `cube-face cube-${side}`, 'aria-label': words.cube.look(words.cube.sides[side]) }, words.cube.sides[side]);
      face.addEventListener('click', () => { this.look(side); });
      return face;
    });
    this.body = element('div', { class: 'cube-body' }, ...faces);
    this.root = element('div', { class: 'cube', role: 'group', 'aria-label': words.cube.title }, this.body);
  }

  /// For the camera as it is.
  show(): void {
    this.body.style.transform = cubeTransform(this.bench.camera.matrixWorldInverse.elements);
  }

  private look(side: Side): void {
    const { target, distance } = this.bench.pose();
    const position = positionFor(side, target.toArray(), distance, this.bench.projection === 'parallel');
    this.bench.fly(CameraPose.from({ position: [position[0], position[1], position[2]], target: [target.x, target.y, target.z] }));
  }
}
