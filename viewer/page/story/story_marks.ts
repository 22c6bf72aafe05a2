// SPDX-License-Identifier: MIT
// The notes of a story on the model: numbered buttons at their places in each frame.
import { Vector4, type PerspectiveCamera, type Vector3 } from 'three';
import { element } from '../parts/element.js';
import { words } from '../words/words.js';

interface Picture {
  readonly width: number;
  readonly height: number;
}

export class StoryMarks {
  readonly root = element('div', { class: 'story-marks' });
  private readonly marks: HTMLButtonElement[];

  /// `chosen`: one was clicked.
  constructor(texts: readonly string[], chosen: (i: number) => void) {
    this.marks = texts.map((text, i) => {
      const number = String(i + 1);
      const mark = element('button', { type: 'button', class: 'story-mark', 'aria-label': words.story.go(number, text), title: text }, number);
      mark.addEventListener('click', () => { chosen(i); });
      return mark;
    });
    this.root.append(...this.marks);
  }

  current(shown: number | null): void {
    this.marks.forEach((mark, i) => { mark.setAttribute('aria-current', i === shown ? 'step' : 'false'); });
  }

  /// `places`: of the notes, in the world. What is behind the camera or outside of the picture is not there.
  place(places: readonly Vector3[], camera: PerspectiveCamera, { width, height }: Picture): void {
    this.marks.forEach((mark, i) => {
      const { x, y, w } = new Vector4(...places[i].toArray(), 1).applyMatrix4(camera.matrixWorldInverse).applyMatrix4(camera.projectionMatrix);
      mark.hidden = !(w > 0 && Math.abs(x) <= w && Math.abs(y) <= w);
      if (!mark.hidden) mark.style.transform = `translate(${(((x / w + 1) / 2) * width).toFixed(1)}px, ${(((1 - y / w) / 2) * height).toFixed(1)}px) translate(-50%, -50%)`;
    });
  }
}
