// SPDX-License-Identifier: MIT
// The parts of a model's view that bars, sheets and keys act upon. Comes once the first picture is drawn.
import { cameraOf } from '../../src/view/pose.js';
import { besideFirst, fittedLink, orderedLink, readLink, writeLink } from '../../src/view/view_link.js';
import type { View } from '../../src/view/view_table.js';
import { NOWHERE, type Spot } from '../address.js';
import type { Shared, SharedSpot } from '../share/embed_code.js';
import { Extensions } from './extensions.js';
import type { FirstParts } from './first_parts.js';
import { firstPose, type FirstView } from './first_view.js';
import { LightDrag } from './light_drag.js';
import type { PageContext } from './page_context.js';
import type { PageFrames } from './page_frames.js';
import { PageStage } from './page_stage.js';
import { PairHost } from './pair_host.js';
import type { Renewal } from './renewal.js';
import { StoryHost } from './story_host.js';
import { ToolHost } from './tool_host.js';
import type { ViewCamera } from './view_camera.js';
import type { ViewChoices } from './view_choices.js';

export class ViewParts {
  readonly context: PageContext;
  readonly choices: ViewChoices;
  readonly camera: ViewCamera;
  readonly renewal: Renewal;
  readonly frames: PageFrames;
  readonly extensions: Extensions;
  readonly story: StoryHost;
  readonly tools: ToolHost;
  readonly pair: PairHost;
  readonly light: LightDrag;
  readonly first: FirstView;

  constructor(private readonly begun: FirstParts) {
    const { context, choices, camera, renewal, frames, first } = begun;
    [this.context, this.choices, this.camera, this.renewal, this.frames, this.first] = [context, choices, camera, renewal, frames, first];
    this.extensions = new Extensions(context, this.choices);
    const stage = new PageStage(context, this.camera, this.choices, this.frames);
    this.pair = new PairHost(stage, this.choices, () => this.spot());
    stage.pair = this.pair;
    this.story = new StoryHost(stage);
    this.tools = new ToolHost(stage, this.story);
    stage.tools = this.tools;
    this.light = new LightDrag((by) => { this.choices.turnLight(by); }, () => { context.dispatchEvent({ type: 'lightKey' }); }, context.signal);
  }

  /// Returns what a link to this view tells, and what it has no room for.
  spot(): SharedSpot {
    const { choices, tools, story, camera, first, extensions, pair } = this;
    const all = orderedLink([camera.text, choices.text, extensions.text, pair.text, tools.text, story.text].filter((text) => text !== '').join('&'));
    const { link, leftOut } = fittedLink(besideFirst(all, first.view));
    return { pose: camera.navigation.atHome ? null : camera.pose(), choices: link, leftOut };
  }

  /// All that is seen, as a view that others may see first: a story and notes are told beside it.
  seen(): View {
    const { pose, choices } = this.firstSpot();
    return { ...readLink(choices), camera: pose === null ? undefined : cameraOf(pose) };
  }

  /// The same as a link has it. The first view's camera is said, too.
  firstSpot(): Spot {
    const { pose, choices } = this.spot();
    const first = firstPose(this.context.view.manifest, this.context.view.standing);
    return { pose: pose ?? first, choices: writeLink({ ...readLink(choices), notes: undefined, story: undefined }) };
  }

  /// As FirstParts.follow(), with all parts.
  follow(spot: Spot): void {
    const shown = this.begun.follow(spot);
    for (const part of [this.pair, this.tools, this.story, this.extensions]) part.follow(shown);
  }

  /// As the model is seen first.
  reset(): void {
    this.camera.navigation.goHome();
    this.follow(NOWHERE);
    this.context.startRest();
  }

  /// Returns what other pages need to show the same. The address tells of the camera as it is, even before it has come to rest.
  shared(): Shared {
    this.context.rest();
    const { name, url, files } = this.context.model;
    return { page: location.origin + location.pathname, name, url, story: this.story.address, other: this.context.arrival.other?.url ?? null, isWhole: files !== undefined, ...this.spot() };
  }

  /// Out of the depth first, then to the gallery.
  back(): void {
    const { context } = this;
    if (context.isOpened && context.view.stats().mode !== 'CWV' && !this.camera.navigation.atHome) this.camera.navigation.goHome();
    else {
      context.rest();
      context.page.dispatchEvent(new Event('leave'));
    }
  }
}
