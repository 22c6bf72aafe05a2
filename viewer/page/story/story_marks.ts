// SPDX-License-Identifier: MIT
// The notes of a story on the model: numbered buttons at their places in each frame.
import { Vector4, type PerspectiveCamera } from 'three';
import type { Stories } from '../../src/plugins/stories.js';
import { element } from '../parts/element.js';
import { placeOf } from '../../src/tools/picture_place.js';
import { words } from '../words/words.js';

export class StoryMarks {
  readonly root = element('div', { class: 'story-marks' });
  private readonly marks: HTMLButtonElement[];

  constructor(private readonly stories: Stories) {
    this.marks = stories.story.notes.map(({ text }, i) => {
      const number = String(i + 1);
      const mark = element('button', { type: 'button', class: 'story-mark', 'aria-label': words.story.go(number, text), title: text }, number);
      mark.addEventListener('click', () => { stories.turnTo(i); });
      return mark;
    });
    this.root.append(...this.marks);
    stories.addEventListener('shown', () => { this.showStep(); });
    this.showStep();
  }

  private showStep(): void {
    this.marks.forEach((mark, i) => { mark.setAttribute('aria-current', i === this.stories.step ? 'step' : 'false'); });
  }

  /// `picture`: the marks lie over it. A mark behind the camera or outside of the picture is not there.
  place(camera: PerspectiveCamera, picture: HTMLElement): void {
    const places = this.stories.marks();
    this.marks.forEach((mark, i) => {
      const clip = new Vector4(...places[i].toArray(), 1).applyMatrix4(camera.matrixWorldInverse).applyMatrix4(camera.projectionMatrix);
      mark.hidden = !(clip.w > 0 && Math.abs(clip.x) <= clip.w && Math.abs(clip.y) <= clip.w);
      if (mark.hidden) return;
      const { x, y } = placeOf(clip, picture);
      mark.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
    });
  }
}
