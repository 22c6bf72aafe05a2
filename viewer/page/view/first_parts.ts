// SPDX-License-Identifier: MIT
// The parts of a model's view that its first picture needs, and the camera: what else there is comes once that is drawn.
import { overFirst } from '../../src/view/view_link.js';
import type { Spot } from '../address.js';
import { FirstView } from './first_view.js';
import { PageContext, type Arrival } from './page_context.js';
import { PageFrames } from './page_frames.js';
import { Renewal } from './renewal.js';
import { ViewCamera } from './view_camera.js';
import { ViewChoices } from './view_choices.js';

export class FirstParts {
  readonly context: PageContext;
  readonly choices: ViewChoices;
  readonly camera: ViewCamera;
  readonly renewal: Renewal;
  readonly frames: PageFrames;
  readonly first: FirstView;

  /// Throws Error where there is no WebGL 2. `come`: the manifest has a view to follow.
  constructor(arrival: Arrival, come: () => void) {
    const context = new PageContext(arrival);
    this.context = context;
    this.choices = new ViewChoices(context);
    this.camera = new ViewCamera(context);
    this.renewal = new Renewal(context);
    this.frames = new PageFrames(context, this.camera, this.renewal);
    this.first = new FirstView(context, come);
  }

  /// Shows what a link says, and of what it says nothing as the model is seen first. Returns all of that as a link.
  follow({ choices }: Spot): string {
    const shown = overFirst(choices, this.first.view);
    for (const part of [this.camera, this.choices]) part.follow(shown);
    return shown;
  }
}
