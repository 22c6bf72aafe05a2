// SPDX-License-Identifier: MIT
// A model, as large as the window, and all that can be done with it.
import type { HierarchyView, Stats } from '../../src/index.js';
import type { Pose, Spot } from '../address.js';
import { COLOURS } from '../appearance.js';
import type { Model } from '../listing.js';
import type { Shared } from '../share/embed_code.js';
import { Chrome, type Orders } from './chrome.js';
import { Extensions } from './extensions.js';
import { PageFrames } from './page_frames.js';
import { Gestures } from './gestures.js';
import { LightDrag } from './light_drag.js';
import { listenToKeys, type Commands } from './keys.js';
import { Notices } from './notices.js';
import { PageStage } from './page_stage.js';
import { Renewal } from './renewal.js';
import { StoryHost } from './story_host.js';
import { ToolHost } from './tool_host.js';
import { ViewCamera } from './view_camera.js';
import { ViewChoices } from './view_choices.js';
import { PageContext, type Surroundings } from './page_context.js';
import '../style/view.css';

export { RootPicture } from './root_picture.js'; // for the gallery, which has loaded this by then
export type { Surroundings } from './page_context.js';

export class ModelView {
  private readonly context: PageContext;
  private readonly choices: ViewChoices;
  private readonly camera: ViewCamera;
  private readonly renewal: Renewal;
  private readonly frames: PageFrames;
  private readonly extensions: Extensions;
  private readonly story: StoryHost;
  private readonly tools: ToolHost;
  private readonly chrome: Chrome;
  private readonly light: LightDrag;

  /// Throws Error where there is no WebGL 2.
  constructor(model: Model, private readonly around: Surroundings) {
    const context = new PageContext(model, around);
    this.context = context;
    this.choices = new ViewChoices(context);
    this.camera = new ViewCamera(context);
    this.renewal = new Renewal(context);
    this.frames = new PageFrames(context, this.camera, this.renewal);
    const stage = new PageStage(context, this.camera, this.choices, this.frames);
    new Notices(context, this.frames);
    this.extensions = new Extensions(context, this.choices);
    this.story = new StoryHost(stage);
    this.tools = new ToolHost(stage, this.story);
    this.chrome = new Chrome(context, this.choices, this.orders());
    this.light = new LightDrag((by) => { this.choices.turnLight(by); }, () => { this.chrome.settings.toggle(); }, context.signal);
    const { surface, view: { plugins } } = context;
    new Gestures(surface, this.camera.navigation, (right, up) => plugins.tapped(right, up), (right, up) => this.light.drag(right, up));
    listenToKeys(this.commands(), context.signal);
    for (const part of [this.tools, this.story]) part.follow(around.spot);
    context.addEventListener('rested', () => { around.rested(this.spot()); });
  }

  /// Once it is on the page.
  start(): void {
    const { around: { preferences, spot } } = this;
    this.choices.show();
    if (preferences.panel) this.chrome.panel.open();
    if (spot.pose !== null) this.setPose(spot.pose);
    this.context.surface.focus({ preventScroll: true });
    void this.renewal.open();
    this.frames.start();
  }

  get root(): HTMLElement {
    return this.context.root;
  }

  get view(): HierarchyView {
    return this.context.view;
  }

  pose(): Pose {
    return this.camera.pose();
  }

  /// Null: all of the model.
  setPose(pose: Pose | null): void {
    this.camera.setPose(pose);
  }

  /// As a link says.
  setSpot(spot: Spot): void {
    this.setPose(spot.pose);
    for (const part of [this.choices, this.tools, this.story]) part.follow(spot);
  }

  stats(): Stats {
    return this.view.stats();
  }

  settled(): boolean {
    return this.frames.isSettled;
  }

  themeChanged(): void {
    this.choices.show();
  }

  close(): void {
    this.context.close();
    this.frames.stop();
    this.renewal.close();
    this.view.dispose();
    this.context.canvas.dispose();
    this.root.remove();
  }

  private spot(): Spot {
    const notes = this.tools.notes === null ? '' : `notes=${this.tools.notes}`;
    const story = this.story.linked === null ? '' : `story=${this.story.linked}`;
    const choices = [this.choices.text, notes, story].filter((text) => text !== '').join('&');
    return { pose: this.camera.navigation.atHome ? null : this.pose(), choices };
  }

  private panelShown(open: boolean): void {
    this.around.preferences.panel = open;
    this.around.chosen();
    this.frames.reportSoon();
  }

  /// Out of the depth first, then to the gallery.
  private readonly back = (): void => {
    if (this.context.isOpened && this.view.stats().mode !== 'CWV') this.camera.navigation.goHome();
    else this.leave();
  };

  private leave(): void {
    this.context.rest();
    this.around.leave?.();
  }

  /// The address tells of the camera as it is, even before it has come to rest.
  private shared(): Shared {
    this.context.rest();
    const { name, url, files } = this.context.model;
    return { page: location.origin + location.pathname, name, url, story: this.story.address, isWhole: files !== undefined, ...this.spot() };
  }

  private orders(): Orders {
    const { choices, camera, around } = this;
    return {
      back: around.leave === null ? null : this.back,
      home: () => { camera.navigation.goHome(); },
      zoom: (logarithm) => { camera.zoomMiddle(logarithm); },
      tools: () => void this.tools.use(null),
      story: () => { this.story.toggle(); },
      immerse: (mode) => void this.extensions.immerse(mode),
      panelShown: (open) => { this.panelShown(open); },
      shared: () => this.shared(),
      look: (look) => { choices.choose({ look }); },
      light: (light) => { choices.choose({ light }); },
      dragsLight: (does) => { this.light.isChosen = does; },
      standing: (standing) => { choices.choose({ standing }); },
      settings: (change) => { choices.setSettings(change); },
      theme: (theme) => { around.setTheme(theme); },
      language: (language) => { around.setLanguage(language); },
    };
  }

  private commands(): Commands {
    const { choices, camera, chrome, tools, story } = this;
    return {
      light: () => { this.light.hold(); },
      nextLight: () => { choices.nextLight(); },
      move: (moves) => { camera.moveByKey(moves); },
      home: () => { camera.navigation.goHome(); },
      back: () => { if (!chrome.sheets.closeAside() && !tools.back() && !chrome.sheets.closeOne() && !story.back()) this.back(); },
      tool: (name) => void tools.use(name),
      colours: (number) => { choices.choose({ look: { colours: COLOURS[number] } }); },
      toggle: (what) => {
        if (what === 'panel' || what === 'settings' || what === 'help') chrome[what].toggle();
        else choices.toggle(what);
      },
    };
  }
}
