// SPDX-License-Identifier: MIT
// The parts of a model's view that bars, sheets and keys act upon.
import type { Spot } from '../address.js';
import type { Shared } from '../share/embed_code.js';
import { Extensions } from './extensions.js';
import { LightDrag } from './light_drag.js';
import { PageContext, type Arrival } from './page_context.js';
import { PageFrames } from './page_frames.js';
import { PageStage } from './page_stage.js';
import { Renewal } from './renewal.js';
import { StoryHost } from './story_host.js';
import { ToolHost } from './tool_host.js';
import { ViewCamera } from './view_camera.js';
import { ViewChoices } from './view_choices.js';

export class ViewParts {
  readonly context: PageContext;
  readonly choices: ViewChoices;
  readonly camera: ViewCamera;
  readonly renewal: Renewal;
  readonly frames: PageFrames;
  readonly extensions: Extensions;
  readonly story: StoryHost;
  readonly tools: ToolHost;
  readonly light: LightDrag;

  /// Throws Error where there is no WebGL 2.
  constructor(arrival: Arrival) {
    const context = new PageContext(arrival);
    this.context = context;
    this.choices = new ViewChoices(context);
    this.camera = new ViewCamera(context);
    this.renewal = new Renewal(context);
    this.frames = new PageFrames(context, this.camera, this.renewal);
    this.extensions = new Extensions(context, this.choices);
    const stage = new PageStage(context, this.camera, this.choices, this.frames);
    this.story = new StoryHost(stage);
    this.tools = new ToolHost(stage, this.story);
    this.light = new LightDrag((by) => { this.choices.turnLight(by); }, () => { context.dispatchEvent({ type: 'lightKey' }); }, context.signal);
  }

  /// Returns what a link to this view tells.
  spot(): Spot {
    const { choices, tools, story, camera } = this;
    const told = story.linked === null ? '' : `story=${story.linked}`;
    return { pose: camera.navigation.atHome ? null : camera.pose(), choices: [choices.text, tools.links, told].filter((text) => text !== '').join('&') };
  }

  /// Returns what other pages need to show the same. The address tells of the camera as it is, even before it has come to rest.
  shared(): Shared {
    this.context.rest();
    const { name, url, files } = this.context.model;
    return { page: location.origin + location.pathname, name, url, story: this.story.address, isWhole: files !== undefined, ...this.spot() };
  }

  /// Out of the depth first, then to the gallery.
  back(): void {
    const { context } = this;
    if (context.isOpened && context.view.stats().mode !== 'CWV') this.camera.navigation.goHome();
    else {
      context.rest();
      context.page.dispatchEvent(new Event('leave'));
    }
  }
}
