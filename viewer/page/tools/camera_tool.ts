// SPDX-License-Identifier: MIT
// Bookmarks, turntable, full screen, and pictures of any size.
import type { Bookmark } from '../../src/tools/notes.js';
import { MOST_SIZE, takePicture } from '../../src/tools/screenshot.js';
import { STEP, Turntable } from '../../src/tools/turntable.js';
import { isTyped } from '../../src/typing.js';
import { checkbox } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { CameraPose } from '../../src/scene/camera_pose.js';
import { turn } from '../view/camera_moves.js';
import { download } from './download.js';
import { entryList, type Entry } from './entry_list.js';
import { textButton } from './figures.js';
import { isKey } from './keys.js';
import { Places } from '../../src/tools/places.js';
import type { Tool } from './tool.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

const PATIENCE = 120_000; // milliseconds until a picture is taken of what is there
const POLL = 100; // milliseconds
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
  private readonly shot = textButton(words.camera.shot, () => void this.takeShot());
  private isTransparent = false;
  private readonly ending = new AbortController();
  private readonly places: Places;

  constructor(private readonly shop: Workshop) {
    const { surface, root, view } = shop.bench;
    this.places = new Places(view);
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
    this.root = element('div', {}, this.list, textButton(camera.add, () => { this.bookmark(); }), this.spinButton, full, width.root, height.root, bare.root, this.shot, this.note);
    for (const sign of ['pointerdown', 'wheel'] as const) surface.addEventListener(sign, () => { this.stop(); }, { signal: this.ending.signal, passive: true });
    root.addEventListener('keydown', (event) => { if (event.key.startsWith('Arrow') && !isTyped(event)) this.stop(); }, { signal: this.ending.signal });
    shop.notebook.onChange(() => { this.show(); });
    this.show();
  }

  key(key: string): boolean {
    if (isKey(key, 'bookmark')) this.bookmark();
    else if (isKey(key, 'spin')) this.spin();
    else if (isKey(key, 'fullScreen')) void this.fullScreen();
    else return false;
    return true;
  }

  /// After each frame.
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
    const { bench, notebook } = this.shop;
    const { position, target } = bench.pose();
    const name = words.camera.bookmark(String(notebook.bookmarks.length + 1));
    notebook.add({ notes: [], bookmarks: [{ name, position: this.places.toInput(position), target: this.places.toInput(target) }] });
  }

  private entryOf(mark: Bookmark): Entry {
    const { bench, notebook } = this.shop;
    const change = (to: readonly Bookmark[]): void => {
      notebook.bookmarks = notebook.bookmarks.flatMap((each) => (each === mark ? to : [each]));
      notebook.changed();
    };
    return {
      text: mark.name,
      rename: (name) => { change([{ ...mark, name }]); },
      go: () => { bench.fly(new CameraPose(this.places.toWorld(mark.position), this.places.toWorld(mark.target))); },
      remove: () => { change([]); },
    };
  }

  private show(): void {
    this.list.replaceChildren(...entryList(this.shop.notebook.bookmarks.map((mark) => this.entryOf(mark)), words.camera.bookmark));
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
      await this.settled();
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

  /// As fine as the picture asks for.
  private async settled(): Promise<void> {
    const end = performance.now() + PATIENCE;
    do await new Promise((resolve) => setTimeout(resolve, POLL));
    while (!this.shop.bench.view.stats().settled && performance.now() < end && !this.ending.signal.aborted);
  }
}

export function makeTool(shop: Workshop): Tool {
  return new CameraTool(shop);
}
