// SPDX-License-Identifier: MIT
// Bookmarks, turntable, full screen, and pictures of any size.
import type { Bookmark } from '../../src/tools/notes.js';
import type { Projection } from '../../src/scene/projection.js';
import { MOST_SIZE, takePicture } from '../../src/tools/screenshot.js';
import { STEP, Turntable } from '../../src/tools/turntable.js';
import { isTyped } from '../../src/typing.js';
import { checkbox, choice, type ChoiceControl } from '../parts/controls.js';
import { element, iconButton } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { CameraPose } from '../../src/scene/camera_pose.js';
import { turn } from '../view/camera_moves.js';
import { download } from './download.js';
import { textButton } from './figures.js';
import { isKey } from './keys.js';
import type { Tool } from './tool.js';
import { untilSettled } from './until_settled.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

const MOST_LETTERS = 500; // of a bookmark's name
const WHITE = [255, 255, 255];

const still = matchMedia('(prefers-reduced-motion: reduce)');

function numberField(name: string, value: number): { root: HTMLElement; input: HTMLInputElement } {
  const input = element('input', { type: 'number', class: 'tool-number', min: '1', max: String(MOST_SIZE), step: '1', inputmode: 'numeric' });
  input.value = String(value);
  return { root: element('label', { class: 'tool-field' }, name, input), input };
}

export class CameraTool implements Tool {
  readonly root: HTMLElement;
  private readonly list = element('ul', { class: 'tool-list' });
  private readonly note = element('p', { class: 'tool-note', 'aria-live': 'polite' });
  private readonly table = new Turntable();
  private readonly spinButton = textButton(words.camera.spin, () => { this.spin(); });
  private readonly width: HTMLInputElement;
  private readonly height: HTMLInputElement;
  private readonly projection: ChoiceControl<Projection> = choice(words.camera.projection, Object.entries(words.camera.projections) as [Projection, string][], (projection) => {
    this.shop.bench.projection = projection;
  });
  private readonly shot = textButton(words.camera.shot, () => void this.takeShot());
  private isTransparent = false;
  private readonly ending = new AbortController();

  constructor(private readonly shop: Workshop) {
    const { surface, root } = shop.bench;
    const { camera } = words;
    const ratio = window.devicePixelRatio;
    const [width, height] = [numberField(camera.width, Math.round(surface.clientWidth * ratio)), numberField(camera.height, Math.round(surface.clientHeight * ratio))];
    this.width = width.input;
    this.height = height.input;
    const bare = checkbox(camera.transparent, null, (on) => { this.isTransparent = on; });
    const full = textButton(camera.fullScreen, () => void this.fullScreen());
    full.hidden = !document.fullscreenEnabled;
    this.spinButton.setAttribute('aria-pressed', 'false');
    for (const { root } of [width, height, bare]) root.classList.add('tool-extra');
    this.root = element('div', {}, this.projection.root, this.list, textButton(camera.add, () => { this.bookmark(); }), this.spinButton, full, width.root, height.root, bare.root, this.shot, this.note);
    for (const sign of ['pointerdown', 'wheel'] as const) surface.addEventListener(sign, () => { this.stop(); }, { signal: this.ending.signal, passive: true });
    root.addEventListener('keydown', (event) => { if (event.key.startsWith('Arrow') && !isTyped(event)) this.stop(); }, { signal: this.ending.signal });
    shop.notebook.onChange(() => { this.show(); });
    shop.bench.onProjection((projection) => { this.projection.show(projection); });
    this.show();
  }

  key(key: string): boolean {
    if (isKey(key, 'bookmark')) this.bookmark();
    else if (isKey(key, 'spin')) this.spin();
    else if (isKey(key, 'fullScreen')) void this.fullScreen();
    else return false;
    return true;
  }

  drawn(): void {
    if (!this.table.isOn) return;
    const { bench } = this.shop;
    bench.jump(turn(bench.pose(), this.table.take(performance.now()), 0));
  }

  close(): void {
    this.ending.abort();
    this.table.stop();
  }

  // ---- bookmarks

  private bookmark(): void {
    const { bench, notebook, places } = this.shop;
    const { position, target } = bench.pose();
    const name = words.camera.bookmark(String(notebook.bookmarks.length + 1));
    notebook.add({ notes: [], bookmarks: [{ name, position: places.toInput(position), target: places.toInput(target) }] });
  }

  private show(): void {
    this.list.replaceChildren(...this.shop.notebook.bookmarks.map((mark, i) => this.rowOf(mark, words.camera.bookmark(String(i + 1)))));
  }

  /// `name`: what the row is called, whatever the bookmark is.
  private rowOf(mark: Bookmark, name: string): HTMLElement {
    const { bench, notebook, places } = this.shop;
    const change = (to: readonly Bookmark[]): void => {
      notebook.bookmarks = notebook.bookmarks.flatMap((each) => (each === mark ? to : [each]));
      notebook.changed();
    };
    const input = element('input', { type: 'text', class: 'tool-text', 'aria-label': name, maxlength: String(MOST_LETTERS) });
    input.value = mark.name;
    input.addEventListener('change', () => { change([{ ...mark, name: input.value }]); });
    const go = iconButton(words.list.go(name), ICONS.go, () => { bench.fly(new CameraPose(places.toWorld(mark.position), places.toWorld(mark.target))); });
    return element('li', {}, input, go, iconButton(words.list.remove(name), ICONS.close, () => { change([]); }));
  }

  // ---- turntable

  /// Who asks for less motion gets a step at once.
  private spin(): void {
    const { bench } = this.shop;
    if (this.table.isOn) this.stop();
    else if (still.matches) bench.jump(turn(bench.pose(), STEP, 0));
    else {
      this.table.start(performance.now());
      this.spinButton.setAttribute('aria-pressed', 'true');
      bench.redraw();
    }
  }

  private stop(): void {
    this.table.stop();
    this.spinButton.setAttribute('aria-pressed', 'false');
  }

  // ---- pictures

  private async fullScreen(): Promise<void> {
    try {
      if (document.fullscreenElement) await document.exitFullscreen();
      else await document.documentElement.requestFullscreen();
    } catch {
      this.note.textContent = words.camera.noFullScreen;
    }
  }

  private async takeShot(): Promise<void> {
    const { bench } = this.shop;
    const size = { width: Math.round(this.width.valueAsNumber), height: Math.round(this.height.valueAsNumber) };
    if (!(size.width >= 1 && size.height >= 1 && size.width <= MOST_SIZE && size.height <= MOST_SIZE)) {
      this.note.textContent = words.camera.badSize(String(MOST_SIZE));
      return;
    }
    this.stop();
    this.shot.disabled = true;
    this.note.textContent = words.camera.working;
    const stage = bench.freeze(size);
    try {
      await untilSettled(bench, this.ending.signal);
      const picture = await takePicture(size, stage.draw, this.isTransparent ? null : WHITE);
      if (!this.ending.signal.aborted) download(picture, `${bench.name}.png`);
      this.note.textContent = '';
    } catch (problem) {
      this.note.textContent = words.camera.failed(problem instanceof Error ? problem.message : String(problem));
    } finally {
      stage.release();
      this.shot.disabled = false;
    }
  }
}

export function makeTool(shop: Workshop): Tool {
  return new CameraTool(shop);
}
