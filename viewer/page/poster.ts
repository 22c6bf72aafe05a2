// SPDX-License-Identifier: MIT
// A hierarchy's own picture in the place of the model, until that is drawn.
//
//   the window                 The picture has the whole model seen without perspective, with room around it. The page's first
//  +---------------+           camera has the model as large as the window lets it be, and in its middle: so stands what the
//  |   .-------.   |           picture shows, whose extent its alpha tells.
//  |  (  model  )  |
//  |   '-------'   |
//  +---------------+
import { boxOf, placeIn } from '../src/scene/poster_place.js';

/// In the browser's own account of the page's times.
const PREVIEW = 'meshhier: preview';
const FADE = 200; // milliseconds
const STILL = matchMedia('(prefers-reduced-motion: reduce)');

export class Poster {
  /// Resolves once it has come, or does not.
  readonly came: Promise<void>;
  private readonly image = new Image();
  private readonly stage = document.createElement('div');
  private readonly ending = new AbortController();

  /// Fetches the picture at once. `name`: the model's, for those who do not see.
  constructor(url: string, name: string) {
    const { image, stage } = this;
    stage.className = 'poster';
    Object.assign(image, { alt: name, crossOrigin: 'anonymous', fetchPriority: 'high', src: url });
    this.came = image.decode().then(() => { this.show(); }, () => undefined); // not every hierarchy has one
  }

  /// It is on the page, and what takes its place may move.
  get isMoving(): boolean {
    return this.stage.isConnected && !STILL.matches;
  }

  /// The model is drawn in its place.
  fade(): void {
    if (STILL.matches) {
      this.end();
      return;
    }
    this.stage.style.opacity = '0';
    window.setTimeout(() => { this.end(); }, FADE);
  }

  end(): void {
    this.ending.abort();
    this.stage.remove();
  }

  private show(): void {
    const { image, stage, ending: { signal } } = this;
    const box = boxOf(image);
    if (signal.aborted || box === null) return;
    const place = (): void => {
      const { left, top, side } = placeIn(box, innerWidth, innerHeight);
      Object.assign(image.style, { left: `${left}px`, top: `${top}px`, width: `${side}px`, height: `${side}px` });
    };
    place();
    window.addEventListener('resize', place, { signal });
    stage.append(image);
    document.body.append(stage);
    requestAnimationFrame(() => { performance.mark(PREVIEW); });
  }
}
