// SPDX-License-Identifier: MIT
// A model, as large as the window, and all that can be done with it.
import { Box3, Vector3 } from 'three';
import { HierarchyProblem, HierarchyView, type Look, type Settings, type Standing, type Stats, type ViewOptions } from '../../src/index.js';
import type { PictureSize } from '../../src/tools/screenshot.js';
import { problemOfPose, roundedPose, type Pose, type Spot } from '../address.js';
import { COLOURS, formatChoices, keepStanding, lastingLook, readStanding, withChoices, type Appearance, type Light } from '../appearance.js';
import { towardsViewer, type Turn } from '../gallery/layout.js';
import { fileOf, type Model } from '../listing.js';
import { element } from '../parts/element.js';
import { formatCount } from '../numbers.js';
import type { Telling } from '../problems.js';
import type { Bench } from '../tools/bench.js';
import type { Preferences, Theme } from '../preferences.js';
import type { Shared } from '../share/embed_code.js';
import { CameraPose } from '../../src/scene/camera_pose.js';
import { ToldLook } from '../story/told_look.js';
import { ImmersionHost } from '../xr/immersion_host.js';
import { immersions } from '../xr/support.js';
import { Chrome } from './chrome.js';
import { FrameLoop, type Pace } from './frame_loop.js';
import { Gestures } from './gestures.js';
import { LightDrag } from './light_drag.js';
import { listenToKeys, type Commands } from './keys.js';
import { Navigation } from './navigation.js';
import { nextLight, Presentation } from './presentation.js';
import { Renewal } from './renewal.js';
import { Sharpness } from './sharpness.js';
import { Stage } from './stage.js';
import { StoryHost, type StorySurroundings } from './story_host.js';
import { ToolHost } from './tool_host.js';
import type { Language } from '../words/languages.js';
import { words } from '../words/words.js';
import '../style/view.css';

export { RootPicture } from './root_picture.js'; // for the gallery, which has loaded this by then

export interface Surroundings extends Pick<ViewOptions, 'fetch' | 'createWorker'> {
  spot: Spot;
  /// As the gallery showed the model, to go on from there; null: it was not turned.
  turn: Turn | null;
  preferences: Preferences;
  /// Preferences have changed.
  chosen(): void;
  setTheme(theme: Theme): void;
  setLanguage(language: Language): void;
  /// To the gallery; null: there is none.
  leave: (() => void) | null;
  /// The address of what is told about the model, or itself; null: nothing is.
  findStory: (signal: AbortSignal) => Promise<string | null>;
  /// The camera stands still, elsewhere than before, or something else was chosen.
  rested(spot: Spot): void;
  /// What it returns takes the message away; one about the same subject takes its place.
  failed(message: string, telling?: Telling): () => void;
  /// Opens the model anew.
  again(): void;
}

/// In the browser's own account of the page's times.
const FIRST_PICTURE = 'meshhier: first picture';
const REST = 300; // milliseconds without movement
const REPORT = 250; // milliseconds between two reports
const UNKNOWN = new Box3(new Vector3(-1, -1, -1), new Vector3(1, 1, 1));

/// Whether a camera can stand so.
function isStanding(pose: CameraPose): boolean {
  const { position, target } = pose.toPose();
  return problemOfPose(position, target) === null;
}

export class ModelView {
  readonly root: HTMLElement;
  readonly view: HierarchyView;
  private readonly tools = new ToolHost({
    bench: () => (this.view.manifest === null ? null : this.bench()),
    noted: () => { this.rest(); },
    failed: (retry) => { this.missCode(retry); },
  });
  private readonly story = new StoryHost({
    teller: () => (this.view.manifest === null ? null : this.teller()),
    find: () => this.around.findStory(this.ending.signal),
    shown: (isTold) => { this.storyShown(isTold); },
    told: () => { this.startRest(); this.redraw(); },
    isWhole: () => this.model.files !== undefined,
    failed: (why, retry) => this.around.failed(words.story.notRead(this.model.name), { more: why, subject: 'story', retry }),
  });
  private readonly toldLook = new ToldLook();
  private readonly immersion: ImmersionHost;
  /// While a picture is taken.
  private frozen: CameraPose | null = null;
  private readonly stage: Stage;
  private readonly presentation: Presentation;
  private readonly navigation: Navigation;
  private readonly loop = new FrameLoop((now) => this.frame(now));
  private readonly chrome: Chrome;
  private readonly ending = new AbortController();
  private readonly light = new LightDrag((by) => { this.choose({ light: this.presentation.turnedLight(by) }); }, () => { this.chrome.settings.toggle(); }, this.ending.signal);
  private readonly sharpness = new Sharpness();
  private readonly sizes = new ResizeObserver(() => { this.loop.wake(); });
  private dirty = true;
  private opened = false;
  private readonly framed = new Box3();
  /// From where the whole is seen until it is there and the camera flies to its first view.
  private approach: ReturnType<typeof towardsViewer> | null = null;
  private shown = false;
  private refused = false;
  private lost: (() => void) | null = null;
  private missing: (() => void) | null = null;
  private refusal: (() => void) | null = null;
  private readonly renewal: Renewal;
  private restTimer = 0;
  private reportedAt = -Infinity;

  /// Throws Error where there is no WebGL 2.
  constructor(
    readonly model: Model,
    private readonly around: Surroundings,
  ) {
    const { fetch, createWorker, preferences: { settings } } = around;
    this.tools.follow(around.spot);
    this.story.follow(around.spot);
    this.stage = new Stage();
    this.view = new HierarchyView(model.url, { fetch, createWorker, settings, files: model.files });
    this.renewal = new Renewal({
      view: this.view,
      name: model.name,
      failed: (message, telling) => around.failed(message, telling),
      opened: () => { this.begin(); },
      refused: (error) => { this.refuse(error); },
      again: () => { around.again(); },
    });
    this.immersion = new ImmersionHost({
      stage: this.stage,
      view: this.view,
      ended: () => { this.redraw(); },
      failed: (why) => { around.failed(words.problems.noImmersion, { more: why, subject: 'immersion' }); },
    });
    this.presentation = new Presentation(this.view, this.stage.lighting, this.wished(around.spot));
    this.presentation.apply();
    this.stage.show(this.view);
    if (around.turn !== null && this.view.standing.up === 'file') this.approach = towardsViewer(around.turn);
    this.navigation = new Navigation((right, up) => this.stage.pick(right, up), () => { this.redraw(); });
    const surface = this.makeSurface();
    this.chrome = new Chrome(model, surface, this.orders(), this.ending.signal);
    this.root = this.chrome.root;
    new Gestures(surface, this.navigation, (right, up) => this.tools.tapped(right, up), (right, up) => this.light.drag(right, up));
    listenToKeys(this.commands(), this.ending.signal);
    this.listen();
  }

  /// Once it is on the page.
  start(): void {
    this.showChosen();
    if (this.around.preferences.panel) this.chrome.panel.open();
    if (this.around.spot.pose !== null) this.setPose(this.around.spot.pose);
    this.sizes.observe(this.stage.canvas);
    this.stage.canvas.parentElement?.focus({ preventScroll: true });
    this.view.opened.then(() => { this.begin(); }, (error: unknown) => { this.refuse(error); });
    this.loop.wake();
  }

  pose(): Pose {
    return roundedPose(this.navigation.pose.toPose());
  }

  /// Null: all of the model.
  setPose(pose: Pose | null): void {
    if (pose === null) this.navigation.goHome();
    else this.navigation.jump(CameraPose.from(pose));
  }

  /// As a link says.
  setSpot(spot: Spot): void {
    this.setPose(spot.pose);
    this.presentAs(this.wished(spot));
    this.tools.follow(spot);
    this.story.follow(spot);
  }

  /// What is kept of this browser's wishes, and what a link says instead.
  private wished({ choices }: Spot): Appearance {
    const { look, light, standings } = this.around.preferences;
    return withChoices(choices, { look, light, standing: readStanding(standings[this.model.url]) });
  }

  stats(): Stats {
    return this.view.stats();
  }

  settled(): boolean {
    return this.opened && !this.dirty && this.lost === null && !this.navigation.busy && !this.sharpness.blurred && this.view.stats().settled;
  }

  themeChanged(): void {
    this.showChosen();
    this.redraw();
  }

  close(): void {
    this.ending.abort();
    this.immersion.stop();
    this.loop.stop();
    this.sizes.disconnect();
    window.clearTimeout(this.restTimer);
    this.renewal.close();
    this.view.dispose();
    this.stage.dispose();
    this.root.remove();
  }

  private get closed(): boolean {
    return this.ending.signal.aborted;
  }

  private makeSurface(): HTMLElement {
    const name = words.view.surface(this.model.name);
    const surface = element('div', { class: 'surface', tabindex: '0', role: 'application', 'aria-label': name });
    surface.append(this.stage.canvas);
    return surface;
  }

  private listen(): void {
    const { signal } = this.ending;
    const { canvas } = this.stage;
    this.view.addEventListener('change', this.loop.wake);
    this.view.addEventListener('problem', ({ message, files }) => { this.miss(message, files); });
    this.view.addEventListener('recovered', () => { this.missing?.(); });
    this.view.addEventListener('replaced', () => { this.missing?.(); });
    canvas.addEventListener('webglcontextlost', () => { this.lost = this.around.failed(words.problems.pictureLost, { more: words.problems.pictureLostMore }); }, { signal });
    canvas.addEventListener('webglcontextrestored', () => { this.restored(); }, { signal });
    document.addEventListener('visibilitychange', () => { this.redraw(); }, { signal });
  }

  /// However many files are missing, they are one message.
  private miss(message: string, files: number): void {
    const text = words.problems.missing(this.model.name, files, formatCount(files));
    this.missing = this.around.failed(text, { more: message, subject: 'missing', retry: () => { this.view.retry(); } });
  }

  private missCode(again: () => void): void {
    const retry = (): void => {
      done();
      again();
    };
    const done = this.around.failed(words.problems.noCode, { more: words.problems.noCodeMore, subject: 'tools', retry });
  }

  private restored(): void {
    this.lost?.();
    this.lost = null;
    this.redraw();
  }

  private begin(): void {
    if (this.closed) return;
    this.refusal?.();
    this.refused = false;
    this.opened = true;
    immersions().then((modes) => { this.chrome.tellImmersions(modes); }, () => undefined);
    this.presentation.apply(); // what the model is may choose for it
    this.occlude();
    this.showChosen();
    this.reframe();
    this.redraw();
  }

  private reframe(): void {
    this.framed.copy(this.view.box);
    this.navigation.frame(this.framed, this.stage.aspect, this.approach ?? this.view.firstDirection, this.view.shape());
  }

  private arrive(): void {
    const { pose, atHome } = this.navigation;
    this.approach = null;
    this.reframe();
    if (!atHome) return; // it has been moved meanwhile
    this.navigation.jump(pose);
    this.navigation.goHome();
  }

  private refuse(error: unknown): void {
    if (this.closed) return;
    this.refused = true;
    this.redraw();
    const why = error instanceof Error ? error.message : String(error);
    const passes = error instanceof HierarchyProblem && error.mayPass;
    const { notOpened, notAHierarchy } = words.problems;
    const more = passes ? why : `${why}. ${notAHierarchy(this.model.url)}`;
    this.missing?.();
    this.refusal = this.around.failed(notOpened(this.model.name), { more, subject: 'refused', retry: () => { this.around.again(); } });
    if (passes) this.renewal.later();
  }

  private redraw(): void {
    this.dirty = true;
    this.loop.wake();
  }

  private frame(now: number): Pace {
    if (this.lost !== null || this.immersion.isOn) return 'rest';
    if (this.approach !== null && this.shown && this.view.manifest !== null) this.arrive();
    const moved = this.frozen === null && this.navigation.step(now);
    if (moved) this.startRest();
    const { framesPerSecond } = this.view.settings;
    const resized = this.stage.fit(this.sharpness.at(now, moved, framesPerSecond));
    // The manifest knows the box better than the root.
    if (this.opened && (resized || !this.framed.equals(this.view.box))) this.reframe();
    this.stage.aim(this.frozen ?? CameraPose.from(this.pose()), this.opened ? this.view.box : UNKNOWN);
    const news = this.view.update(this.stage.camera, this.stage.size, now);
    if (moved || news || resized || this.dirty) this.draw();
    this.dirty = false;
    return this.pace(now, moved || news || this.navigation.busy || this.sharpness.blurred);
  }

  private draw(): void {
    if (this.frozen !== null) return; // a picture is being taken: the page's waits
    this.stage.draw();
    this.tools.drawn();
    this.story.drawn();
    if (this.opened && !this.shown) performance.mark(FIRST_PICTURE);
    this.shown = this.opened;
  }

  private pace(now: number, busy: boolean): Pace {
    const due = now - this.reportedAt >= REPORT;
    if (busy && !due) return 'busy';
    const stats = this.view.stats();
    const working = !this.refused && !(stats.settled && this.opened);
    if (this.view.manifest !== null) {
      if (this.renewal.know(this.view.manifest)) return 'rest';
      this.chrome.tellSource(this.view.manifest);
      this.tools.showNews();
      if (this.shown) this.story.seek();
    }
    this.reportedAt = now;
    this.chrome.report(stats, this.view.settings.framesPerSecond, working);
    if (busy) return 'busy';
    return working ? 'waiting' : 'rest';
  }

  /// Links tell of the camera when it has come to rest.
  private startRest(): void {
    window.clearTimeout(this.restTimer);
    this.restTimer = window.setTimeout(() => { this.rest(); }, REST);
  }

  private rest(): void {
    window.clearTimeout(this.restTimer);
    this.around.rested(this.spot());
  }

  private spot(): Spot {
    const choices = formatChoices(this.presentation.chosen);
    const notes = this.tools.notes === null ? '' : `notes=${this.tools.notes}`;
    const story = this.story.linked === null ? '' : `story=${this.story.linked}`;
    return { pose: this.navigation.atHome ? null : this.pose(), choices: [choices, notes, story].filter((text) => text !== '').join('&') };
  }

  /// Kept for other models too; but not how this one stands.
  private choose({ look, light, standing }: { look?: Partial<Look>; light?: Partial<Light>; standing?: Partial<Standing> }): void {
    const { preferences } = this.around;
    const { chosen } = this.presentation;
    this.presentation.chosen = {
      look: { ...chosen.look, ...look },
      light: { ...chosen.light, ...light },
      standing: { ...chosen.standing, ...standing },
    };
    Object.assign(preferences.look, lastingLook(look ?? {}));
    Object.assign(preferences.light, light);
    if (standing !== undefined) preferences.standings = keepStanding(preferences.standings, this.model.url, this.presentation.chosen.standing);
    this.around.chosen();
    this.present();
    this.startRest();
  }

  private present(): void {
    this.presentation.apply();
    this.occlude();
    this.showChosen();
    this.redraw();
  }

  private occlude(): void {
    this.stage.setOccluded(this.presentation.chosen.light.occlusion).then((hasCome) => { if (hasCome) this.redraw(); }, () => { this.missCode(() => { this.occlude(); }); });
  }

  private showChosen(): void {
    const { chosen, shown } = this.presentation;
    this.chrome.show({ ...this.around.preferences, ...chosen }, shown.key);
    this.chrome.tellTerrain(this.view.terrain === null ? null : shown);
  }

  private setSettings(change: Partial<Settings>): void {
    this.view.setSettings(change);
    Object.assign(this.around.preferences.settings, change);
    this.around.chosen();
    this.showChosen();
    this.redraw();
  }

  private panelShown(open: boolean): void {
    this.around.preferences.panel = open;
    this.around.chosen();
    this.reportedAt = -Infinity;
    this.loop.wake();
  }

  /// Out of the depth first, then to the gallery.
  private readonly back = (): void => {
    if (this.opened && this.view.stats().mode !== 'CWV') this.navigation.goHome();
    else this.leave();
  };

  private leave(): void {
    this.rest();
    this.around.leave?.();
  }

  private orders(): ConstructorParameters<typeof Chrome>[2] {
    return {
      back: this.around.leave === null ? null : this.back,
      home: () => { this.navigation.goHome(); },
      zoom: (logarithm) => { this.zoomMiddle(logarithm); },
      tools: () => void this.tools.use(null),
      story: () => { this.story.toggle(); },
      immerse: (mode) => void this.immersion.start(mode),
      panelShown: (open) => { this.panelShown(open); },
      shared: () => this.shared(),
      look: (look) => { this.choose({ look }); },
      light: (light) => { this.choose({ light }); },
      dragsLight: (does) => { this.light.isChosen = does; },
      standing: (standing) => { this.choose({ standing }); },
      settings: (change) => { this.setSettings(change); },
      theme: (theme) => { this.around.setTheme(theme); },
      language: (language) => { this.around.setLanguage(language); },
    };
  }

  private bench(): Omit<Bench, 'notes' | 'setNotes'> {
    return {
      name: this.model.name,
      fileName: fileOf(this.model),
      view: this.view,
      camera: this.stage.camera,
      root: this.root,
      surface: this.stage.canvas.parentElement!,
      signal: this.ending.signal,
      pose: () => this.navigation.pose,
      jump: (pose) => { this.navigation.jump(pose); },
      fly: (pose) => { this.flyTo(pose); },
      choices: () => formatChoices(this.presentation.chosen),
      story: () => this.story.told,
      play: (story, from) => void this.story.play(story, from).catch(() => { this.missCode(() => { this.bench().play(story, from); }); }),
      freeze: (size) => this.freeze(size),
      redraw: () => { this.redraw(); },
      setPainter: (painter) => { this.stage.painter = painter; },
      tell: (message, telling) => this.around.failed(message, { ...telling, subject: 'tools' }),
    };
  }

  private teller(): ReturnType<StorySurroundings['teller']> {
    const { view, camera, root, surface, signal, pose } = this.bench();
    return {
      view, camera, root, surface, signal, pose,
      travel: (to) => (isStanding(to) ? this.navigation.travel(to) : 0),
      present: (choices) => { this.presentAs(this.toldLook.tell(choices, this.presentation.chosen)); },
    };
  }

  private presentAs(chosen: Appearance): void {
    this.presentation.chosen = chosen;
    this.present();
  }

  private storyShown(isTold: boolean): void {
    this.chrome.tellStory(isTold);
    if (!isTold) this.presentAs(this.toldLook.end(this.presentation.chosen));
    this.redraw();
  }

  /// Places may be from a file.
  private flyTo(pose: CameraPose): void {
    if (isStanding(pose)) this.navigation.fly(pose);
  }

  private freeze(size: PictureSize): ReturnType<Bench['freeze']> {
    const hold = (asked: PictureSize | null): void => {
      this.frozen = asked && CameraPose.from(this.pose());
      this.stage.asked = asked;
      this.redraw();
    };
    hold(size);
    return { draw: this.stage.drawPart, release: () => { hold(null); } };
  }

  /// The address tells of the camera as it is, even before it has come to rest.
  private shared(): Shared {
    this.rest();
    const { name, url, files } = this.model;
    return { page: location.origin + location.pathname, name, url, story: this.story.address, isWhole: files !== undefined, ...this.spot() };
  }

  private zoomMiddle(logarithm: number): void {
    this.navigation.grab(0, 0);
    this.navigation.move({ zoom: logarithm });
  }

  private commands(): Commands {
    return {
      light: () => { this.light.hold(); },
      nextLight: () => { this.choose({ light: nextLight(this.presentation.chosen.light) }); },
      move: (moves) => { this.moveByKey(moves); },
      home: () => { this.navigation.goHome(); },
      back: () => { if (!this.chrome.sheets.closeAside() && !this.tools.back() && !this.chrome.sheets.closeOne() && !this.story.back()) this.back(); },
      tool: (name) => void this.tools.use(name),
      colours: (number) => { this.choose({ look: { colours: COLOURS[number] } }); },
      toggle: (what) => { this.toggle(what); },
    };
  }

  private moveByKey(moves: Parameters<Commands['move']>[0]): void {
    if (moves.turnRight !== undefined) this.navigation.grabMiddle();
    else this.navigation.grab(0, 0);
    this.navigation.move(moves);
  }

  private toggle(what: Parameters<Commands['toggle']>[0]): void {
    const { look, light } = this.presentation.chosen;
    if (what === 'occlusion') this.choose({ light: { occlusion: !light.occlusion } });
    else if (what === 'flat') this.choose({ look: { shading: look.shading === 'flat' ? 'smooth' : 'flat' } });
    else if (what === 'texture' || what === 'wires' || what === 'points' || what === 'outline' || what === 'cavities') this.choose({ look: { [what]: !look[what] } });
    else this.chrome[what].toggle();
  }
}
