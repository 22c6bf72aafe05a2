// SPDX-License-Identifier: MIT
// Rooms: looks into them from outside, walks through them, and shows one storey.
import { Dollhouse } from '../../src/plugins/dollhouse.js';
import { Storeys } from '../../src/plugins/storeys.js';
import { Walking } from '../../src/plugins/walking.js';
import type { Mark } from '../../src/plugins/overlay.js';
import { magnitude } from '../../src/tools/number_text.js';
import type { Storey } from '../../src/tools/storeys.js';
import { checkbox, slider, type Control } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { textButton } from './figures.js';
import { readLink, writeLink } from '../../src/view/view_link.js';
import { DOLLHOUSE } from '../view/extensions.js';
import type { Tool } from './tool.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';
import './rooms.css';

/// Eyes are from a tenth to four times as high as usual.
const EYES = { least: 0.1, most: 4, step: 0.05 };

/// A floor is known to a hundredth or so of its storey's height.
function toldFloor({ floor, ceiling }: Storey): number {
  const step = 10 ** (magnitude(ceiling - floor) - 2);
  return Number((Math.round(floor / step) * step).toPrecision(12));
}

class RoomsTool implements Tool {
  readonly root: HTMLElement;
  private readonly walking = new Walking({ name: 'page walking', isAlone: false });
  private readonly storeys = new Storeys('page storeys');
  private readonly dollhouse: Dollhouse;
  private readonly look: Control<boolean>;
  private readonly walk = textButton(words.rooms.walk, () => { this.toggleWalk(); });
  private readonly hint = element('p', { class: 'tool-note' });
  private readonly note = element('p', { class: 'tool-note', role: 'status' });
  private readonly range = element('input', { type: 'range', min: '0', step: '1', id: 'room-storeys' });
  private readonly storey = element('output', { for: 'room-storeys' });
  private readonly only: Control<boolean>;
  private readonly house: HTMLElement;
  private isOnly = false;
  private isFollowing = false;

  constructor(private readonly shop: Workshop) {
    const { view } = shop.bench;
    const { rooms } = words;
    this.dollhouse = this.takeDollhouse();
    for (const plugin of [this.walking, this.storeys]) view.registerPlugin(plugin);
    this.look = checkbox(rooms.dollhouse, null, (on) => { this.dollhouse.mode = on ? 'on' : 'off'; this.tell(); });
    this.only = checkbox(rooms.only, null, (on) => { this.isOnly = on; this.chooseStorey(); });
    const usual = this.walking.eyeHeight;
    const eyes = slider(rooms.eyes, shop.scale.sign, { least: EYES.least * usual, most: EYES.most * usual, step: EYES.step * usual }, (height) => { if (height > 0) this.walking.eyeHeight = height; });
    eyes.show(Number(usual.toPrecision(3)));
    eyes.root.classList.add('tool-extra');
    this.range.addEventListener('input', () => { this.chooseStorey(); });
    this.house = element('div', { class: 'room-storeys' },
      element('div', { class: 'slider' }, element('div', { class: 'slider-head' }, element('label', { for: 'room-storeys' }, rooms.storey), this.storey), this.range), this.only.root);
    this.walk.setAttribute('aria-pressed', 'false');
    this.root = element('div', {}, this.walk, this.hint, this.look.root, this.house, eyes.root, this.note);
    for (const plugin of [this.walking, this.storeys]) plugin.addEventListener('change', () => { this.tell(); });
    this.dollhouse.addEventListener('change', () => { this.show(); });
    shop.bench.onProjection((projection) => { if (projection === 'parallel') this.walking.stop(); });
    shop.link('rooms').onFollow(() => { this.follow(); });
    this.follow();
  }

  /// Goes there on foot.
  choose(right: number, up: number): void {
    this.note.textContent = this.walking.goTo(right, up) ? '' : words.rooms.notThere;
  }

  marks(): readonly Mark[] {
    return this.walking.isWalking ? this.walking.marks() : [];
  }

  lasting(): string | null {
    if (this.walking.isWalking) return words.rooms.walking;
    return this.storeys.range === null ? null : words.rooms.cut;
  }

  end(): void {
    if (this.walking.isWalking) this.walking.stop();
    else this.storeys.range = null;
  }

  close(): void {
    for (const plugin of [this.walking, this.storeys]) this.shop.bench.view.unregisterPlugin(plugin);
  }

  /// The page's own, or one of this tool where it has none.
  private takeDollhouse(): Dollhouse {
    const { view } = this.shop.bench;
    const known = view.plugins.named(DOLLHOUSE);
    if (known instanceof Dollhouse) return known;
    const made = new Dollhouse(DOLLHOUSE);
    view.registerPlugin(made);
    return made;
  }

  private toggleWalk(): void {
    if (this.walking.isWalking) this.walking.stop();
    else this.note.textContent = this.startWalk() ? '' : words.rooms.nowhere;
  }

  /// Nobody walks with parallel rays.
  private startWalk(): boolean {
    this.shop.bench.projection = 'perspective';
    return this.walking.start();
  }

  private chooseStorey(): void {
    const number = Number(this.range.value) - 1;
    this.storeys.choose(number < 0 ? null : number, this.isOnly);
    this.show();
  }

  /// Another link.
  private follow(): void {
    const { walk, storey } = readLink(this.shop.link('rooms').text);
    this.isFollowing = true;
    this.storeys.range = storey ?? null;
    this.isOnly = this.storeys.shown?.isAlone ?? false;
    if (walk === true) this.startWalk();
    else this.walking.stop();
    this.isFollowing = false;
    this.show();
  }

  /// Something else was chosen: links have it from now on.
  private tell(): void {
    this.show();
    if (!this.isFollowing) this.shop.link('rooms').write(writeLink({ walk: this.walking.isWalking, storey: this.storeys.range ?? undefined }));
    this.shop.bench.redraw();
  }

  private show(): void {
    const { storeys, shown } = this.storeys;
    const { rooms } = words;
    this.look.show(this.dollhouse.isOn);
    this.walk.setAttribute('aria-pressed', String(this.walking.isWalking));
    this.walk.textContent = this.walking.isWalking ? rooms.stop : rooms.walk;
    this.hint.textContent = this.walking.isWalking ? rooms.walkHint : rooms.hint;
    this.house.hidden = storeys.length === 0;
    this.range.max = String(storeys.length);
    this.range.value = String(shown === null ? 0 : shown.number + 1);
    const text = shown === null ? rooms.allStoreys : rooms.storeyAt(String(shown.number + 1), this.shop.scale.format(toldFloor(storeys[shown.number])));
    this.storey.textContent = text;
    this.range.setAttribute('aria-valuetext', text);
    this.only.show(this.isOnly);
    this.only.root.hidden = shown === null;
  }
}

export function makeTool(shop: Workshop): Tool {
  return new RoomsTool(shop);
}
