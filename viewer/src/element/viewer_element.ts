// SPDX-License-Identifier: MIT
// <meshhier-viewer src="URL of a hierarchy">: a model in any page.
import type { RemoteFiles } from '../hierarchy/files.js';
import type { Pose } from '../scene/camera_pose.js';
import type { Plugin } from '../scene/hierarchy_view.js';
import type { ViewOptions } from '../scene/view_options.js';
import type { Settings } from '../scene/settings.js';
import { cameraOf, poseOf } from '../view/pose.js';
import { writeLink } from '../view/view_link.js';
import { VIEW_TABLE } from '../view/view_table.js';
import { ShownModel } from './shown_model.js';

const NEAR = '300px'; // of the window: what is farther away is not loaded yet
const STYLE = `
:host { display: block; position: relative; overflow: hidden; height: 400px; contain: strict; }
:host([hidden]) { display: none; }
canvas, slot { display: block; position: absolute; inset: 0; width: 100%; height: 100%; }
canvas { touch-action: none; cursor: grab; }
canvas:active { cursor: grabbing; }
canvas:focus-visible { outline: 3px solid Highlight; outline-offset: -3px; }
p { position: absolute; left: 8px; right: 8px; bottom: 8px; margin: 0; padding: 8px 12px; border-radius: 8px;
  background: Canvas; color: CanvasText; font: 14px/1.4 system-ui, sans-serif; overflow-wrap: anywhere; }
button { font: inherit; margin-left: 8px; }
[hidden] { display: none; }`;

/// Outside browsers there are no elements: importing this module there is no error, making one makes nothing.
const Base = (globalThis.HTMLElement as typeof HTMLElement | undefined) ?? (Object as unknown as typeof HTMLElement);

const NUMBERS: Readonly<Record<string, keyof Settings>> = { 'frame-rate': 'framesPerSecond', threshold: 'threshold', 'memory-budget': 'memoryBudget' };

function make<Tag extends keyof HTMLElementTagNameMap>(tag: Tag, attributes: Readonly<Record<string, string>> = {}): HTMLElementTagNameMap[Tag] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

/// Reads the attribute; null: it is no camera.
export function parseCamera(text: string | null): Pose | null {
  const camera = VIEW_TABLE.camera.kind.parse([text ?? '']);
  return camera && poseOf(camera);
}

export function formatCamera(pose: Pose): string {
  return writeLink({ camera: cameraOf(pose) });
}

/// Events: `load`, the model is drawn; `problem`, `event.detail.message` says what failed, the view goes on with what it has;
/// `replaced`, the host has another model by now, what is shown stays (a message offers `reload()`, unless a listener prevents it);
/// `camerachange`, the user has moved it.
export class MeshhierViewerElement extends Base {
  static readonly observedAttributes = ['src', 'camera', 'view', 'label'];
  /// Makes a worker of the module `tile_worker`, which decodes tiles beside the page; for all elements made later.
  static createWorker: (() => Worker) | undefined = undefined;
  /// Gives the files that are read instead of those at a URL, if any; for all elements made later. Throws Error, which is told.
  static filesOf: ((url: string) => RemoteFiles | undefined) | undefined = undefined;

  /// On the button beside a problem; for all elements made later.
  static retryText = 'Retry';
  /// Said of a model that was replaced, and on the button beside it; for all elements made later.
  static replacedText = 'This model was replaced by another one.';
  static reloadText = 'Load it anew';

  private shown: ShownModel | null = null;
  private readonly plugins: (() => Plugin)[] = [];
  private readonly poster: HTMLSlotElement;
  private readonly problem: HTMLElement;
  private readonly text: HTMLElement;
  private readonly button: HTMLButtonElement;
  private isReplaced = false;
  private readonly near: IntersectionObserver;
  private wanted = false; // it is near the window

  constructor() {
    super();
    const root = this.attachShadow({ mode: 'open' });
    const style = make('style');
    style.textContent = STYLE;
    this.poster = make('slot');
    this.text = make('span');
    this.button = make('button', { type: 'button', part: 'retry' });
    this.button.addEventListener('click', () => {
      if (this.isReplaced) this.reload();
      else this.retry();
    });
    this.problem = make('p', { role: 'alert', part: 'problem' });
    this.problem.append(this.text, this.button);
    this.problem.hidden = true;
    root.append(style, this.poster, this.problem);
    this.near = new IntersectionObserver((entries) => { this.seen(entries.some(({ isIntersecting }) => isIntersecting)); }, { rootMargin: NEAR });
  }

  /// The URL of the hierarchy's directory or archive; empty: none.
  get src(): string {
    const given = this.getAttribute('src') ?? '';
    return given === '' ? '' : new URL(given, document.baseURI).href;
  }

  set src(url: string) {
    this.setAttribute('src', url);
  }

  /// As the attribute has it: where the camera is now.
  get camera(): string | null {
    return this.shown === null ? this.getAttribute('camera') : formatCamera(this.shown.pose().toPose());
  }

  set camera(place: string | null) {
    if (place === null) this.removeAttribute('camera');
    else this.setAttribute('camera', place);
  }

  /// For everything else; null until it is near the window.
  get view(): ShownModel['view'] | null {
    return this.shown?.view ?? null;
  }

  connectedCallback(): void {
    this.near.observe(this);
  }

  disconnectedCallback(): void {
    this.near.disconnect();
    this.wanted = false;
    this.close();
  }

  attributeChangedCallback(name: string, before: string | null, now: string | null): void {
    if (before === now) return;
    if (name === 'src' && this.wanted) this.open();
    if (name === 'camera') this.shown?.look(parseCamera(now));
    if (name === 'view') this.shown?.show(now ?? '');
    if (name === 'label' && this.shown !== null) this.name(this.shown.surface);
  }

  /// Makes a plug-in for the model that is shown, and for each that is shown later.
  registerPlugin(make: () => Plugin): void {
    this.plugins.push(make);
    this.use(make);
  }

  /// Asks at once for what failed.
  retry(): void {
    this.problem.hidden = true;
    if (this.shown?.view.manifest != null) this.shown.view.retry();
    else this.open();
  }

  /// Begins anew with what the host has now; the camera stays where the user has put it.
  reload(): void {
    this.problem.hidden = true;
    this.isReplaced = false;
    if (this.shown === null) this.open();
    else this.shown.reload();
  }

  private seen(isNear: boolean): void {
    if (!isNear || this.wanted) return;
    this.wanted = true;
    this.open();
  }

  private open(): void {
    this.close();
    if (this.src === '') return;
    try {
      this.shown = new ShownModel(this.shadowRoot!, this.src, this.options(), parseCamera(this.getAttribute('camera')), {
        opened: () => { this.opened(); },
        problem: (message) => { this.tell(message); },
        recovered: () => { this.problem.hidden = true; },
        replaced: () => { this.replaced(); },
        moved: () => { this.dispatchEvent(new CustomEvent('camerachange')); },
      });
    } catch (error) {
      this.tell(error instanceof Error ? error.message : String(error));
      return;
    }
    this.shown.show(this.getAttribute('view') ?? '');
    const { surface: canvas } = this.shown;
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'application');
    this.name(canvas);
    this.poster.before(canvas);
    this.shown.enter();
    for (const make of this.plugins) this.use(make);
  }

  /// The model is shown without a plug-in that fails.
  private use(make: () => Plugin): void {
    try {
      this.shown?.use(make());
    } catch (error) {
      this.tell(error instanceof Error ? error.message : String(error));
    }
  }

  private close(): void {
    this.shown?.dispose();
    this.shown = null;
    this.poster.hidden = false;
    this.problem.hidden = true;
    this.isReplaced = false;
  }

  private options(): ViewOptions {
    const settings: Partial<Settings> = {};
    for (const [attribute, key] of Object.entries(NUMBERS)) {
      if (this.hasAttribute(attribute)) settings[key] = Number(this.getAttribute(attribute));
    }
    const { createWorker, filesOf } = MeshhierViewerElement;
    return { settings, createWorker, files: filesOf?.(this.src) };
  }

  private name(canvas: HTMLCanvasElement): void {
    canvas.setAttribute('aria-label', this.getAttribute('label') ?? this.src.replace(/^.*\/(.*?)\/*$/, '$1'));
  }

  private opened(): void {
    this.poster.hidden = true;
    this.problem.hidden = true;
    this.dispatchEvent(new CustomEvent('load'));
  }

  private say(message: string, button: string): void {
    this.text.textContent = message;
    this.button.textContent = button;
    this.problem.hidden = false;
  }

  private replaced(): void {
    if (!this.dispatchEvent(new CustomEvent('replaced', { cancelable: true }))) return;
    this.isReplaced = true;
    this.say(MeshhierViewerElement.replacedText, MeshhierViewerElement.reloadText);
  }

  private tell(message: string): void {
    this.say(message, MeshhierViewerElement.retryText);
    this.dispatchEvent(new CustomEvent('problem', { detail: { message } }));
  }
}

/// Makes `<meshhier-viewer>` known to the page; nothing happens where it is, or where there are no elements.
export function defineViewer(): void {
  const registry = globalThis.customElements as CustomElementRegistry | undefined;
  if (registry !== undefined && registry.get('meshhier-viewer') === undefined) registry.define('meshhier-viewer', MeshhierViewerElement);
}

declare global {
  interface HTMLElementTagNameMap {
    'meshhier-viewer': MeshhierViewerElement;
  }
}
