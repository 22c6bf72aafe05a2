// SPDX-License-Identifier: MIT
// Where models lie: marks on a grid of degrees, which open what lies there. Nothing of it is fetched from anybody else.
import '../style/map.css';
import { figure } from '../../src/tools/number_text.js';
import { formatAddress, NOWHERE } from '../address.js';
import type { Model, ModelSpot } from '../listing.js';
import { formatCount, writeDecimal } from '../numbers.js';
import { element, iconButton } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { visit } from '../visits.js';
import { words } from '../words/words.js';
import { clustersOf, frameOf, lineStep, linesWithin, moved, MOST_SCALE, toMap, zoomed, type Cluster, type MapFrame } from './map_frame.js';

export type ModelsAt = (indices: readonly number[]) => Promise<readonly Model[]>;

const ZOOM = 2;
const STEP = 80; // pixels of an arrow key
const MOST_LISTED = 60; // models of a mark
const FEW = 12; // these are listed, more are looked at from nearer
const TAP = 5; // pixels

function degrees(value: number, [negative, positive]: readonly [string, string]): string {
  const text = figure(Math.abs(value), { place: -9, write: writeDecimal });
  return `${text}° ${value < 0 ? negative : value > 0 ? positive : ''}`.trimEnd();
}

export class PlacesMap {
  readonly root: HTMLElement;
  private readonly lines = element('div', { class: 'map-lines', 'aria-hidden': 'true' });
  private readonly marks = element('div', { class: 'map-marks' });
  private readonly sheet: HTMLElement;
  private readonly list = element('ul', { class: 'map-list', 'aria-live': 'polite' });
  private spots: readonly ModelSpot[] = [];
  private frame: MapFrame = { longitude: 0, latitude: 0, scale: 1 };
  private readonly pointers = new Map<number, [number, number]>();
  private drawing = 0;

  constructor(private readonly modelsAt: ModelsAt) {
    const text = words.gallery.mapKeys;
    const buttons = element('div', { class: 'map-buttons' },
      iconButton(text.nearer, ICONS.plus, () => { this.zoom(ZOOM); }),
      iconButton(text.farther, ICONS.minus, () => { this.zoom(1 / ZOOM); }),
      iconButton(text.all, ICONS.home, () => { this.fit(); }));
    this.sheet = element('div', { class: 'map-sheet', tabindex: '0', role: 'group', 'aria-label': text.map, 'aria-keyshortcuts': '+ - 0' }, this.lines, this.marks, buttons);
    this.root = element('section', { class: 'places-map', 'aria-label': words.gallery.map }, this.sheet, this.list);
    this.sheet.addEventListener('keydown', (event) => { this.key(event); });
    this.sheet.addEventListener('wheel', (event) => { this.wheel(event); }, { passive: false });
    this.sheet.addEventListener('pointerdown', (event) => { this.pointers.set(event.pointerId, this.placeOf(event)); });
    this.sheet.addEventListener('pointermove', (event) => { this.drag(event); });
    for (const end of ['pointerup', 'pointercancel', 'pointerleave'] as const) this.sheet.addEventListener(end, ({ pointerId }) => { this.pointers.delete(pointerId); });
    new ResizeObserver(() => { this.draw(); }).observe(this.sheet);
  }

  /// All of them are in view.
  show(spots: readonly ModelSpot[]): void {
    this.spots = spots;
    this.list.replaceChildren();
    this.fit();
  }

  private get size(): { width: number; height: number } {
    return { width: this.sheet.clientWidth, height: this.sheet.clientHeight };
  }

  private fit(): void {
    this.frame = frameOf(this.spots, this.size);
    this.draw();
  }

  private look(frame: MapFrame): void {
    this.frame = frame;
    this.draw();
  }

  private zoom(factor: number, at: readonly [number, number] = [this.size.width / 2, this.size.height / 2]): void {
    this.look(zoomed(this.frame, factor, this.size, at));
  }

  private placeOf({ clientX, clientY }: MouseEvent): [number, number] {
    const { left, top } = this.sheet.getBoundingClientRect();
    return [clientX - left, clientY - top];
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    this.zoom(2 ** (-event.deltaY / (event.deltaMode === 0 ? 300 : 8)), this.placeOf(event));
  }

  /// One finger moves the map, two enlarge it about their middle.
  private drag(event: PointerEvent): void {
    const before = this.pointers.get(event.pointerId);
    if (before === undefined) return;
    const now = this.placeOf(event);
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
    if (other === undefined && !this.sheet.hasPointerCapture(event.pointerId) && Math.hypot(now[0] - before[0], now[1] - before[1]) < TAP) return;
    this.sheet.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, now);
    if (other === undefined) {
      this.look(moved(this.frame, now[0] - before[0], now[1] - before[1]));
      return;
    }
    const apart = (place: readonly [number, number]): number => Math.max(Math.hypot(place[0] - other[0], place[1] - other[1]), 1);
    this.zoom(apart(now) / apart(before), [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2]);
  }

  private key(event: KeyboardEvent): void {
    const { key, ctrlKey, altKey, metaKey, shiftKey } = event;
    const step = { ArrowLeft: [STEP, 0], ArrowRight: [-STEP, 0], ArrowUp: [0, STEP], ArrowDown: [0, -STEP] }[key];
    if (ctrlKey || altKey || metaKey || shiftKey && step !== undefined) return;
    if (step !== undefined) this.look(moved(this.frame, step[0], step[1]));
    else if (key === '+' || key === '=') this.zoom(ZOOM);
    else if (key === '-') this.zoom(1 / ZOOM);
    else if (key === '0') this.fit();
    else return;
    event.preventDefault();
  }

  /// With the next frame, once.
  private draw(): void {
    if (this.drawing !== 0) return;
    this.drawing = requestAnimationFrame(() => {
      this.drawing = 0;
      if (this.size.width === 0) return;
      this.drawLines();
      this.drawMarks();
    });
  }

  private drawLines(): void {
    const { frame, size } = this;
    const step = lineStep(frame.scale);
    const half = { up: size.height / 2 / frame.scale, across: size.width / 2 / (toMap(frame, size, [frame.longitude + 1, 0])[0] - size.width / 2) };
    const line = (name: string, style: Partial<CSSStyleDeclaration>, text: string): HTMLElement => {
      const made = element('span', { class: name }, element('span', {}, text));
      Object.assign(made.style, style);
      return made;
    };
    const upright = linesWithin(Math.max(frame.longitude - half.across, -180), Math.min(frame.longitude + half.across, 180), step)
      .map((at) => line('meridian', { left: `${toMap(frame, size, [at, 0])[0]}px` }, degrees(at, words.gallery.mapKeys.westEast)));
    const level = linesWithin(Math.max(frame.latitude - half.up, -90), Math.min(frame.latitude + half.up, 90), step)
      .map((at) => line('parallel', { top: `${toMap(frame, size, [0, at])[1]}px` }, degrees(at, words.gallery.mapKeys.southNorth)));
    this.lines.replaceChildren(...upright, ...level);
  }

  /// The mark that has the focus keeps it, as far as there still is one of its model.
  private drawMarks(): void {
    const focused = this.marks.contains(document.activeElement) ? document.activeElement?.getAttribute('data-first') : null;
    const clusters = clustersOf(this.spots, this.frame, this.size);
    clusters.sort((a, b) => a.y - b.y || a.x - b.x);
    this.marks.replaceChildren(...clusters.map((cluster) => this.markOf(cluster)));
    if (typeof focused === 'string') (this.marks.querySelector<HTMLElement>(`[data-first="${focused}"]`) ?? this.sheet).focus({ preventScroll: true });
  }

  private markOf(cluster: Cluster): HTMLElement {
    const count = cluster.spots.length;
    const name = words.counts.models(count, formatCount(count));
    const mark = element('button', { type: 'button', class: 'map-mark', 'aria-label': name, title: name, 'data-first': String(cluster.spots[0][2]) }, count > 1 ? formatCount(count) : null);
    mark.classList.toggle('one', count === 1);
    Object.assign(mark.style, { left: `${cluster.x}px`, top: `${cluster.y}px` });
    mark.addEventListener('click', () => void this.choose(cluster));
    if (count === 1) for (const type of ['pointerenter', 'focus'] as const) mark.addEventListener(type, () => void this.nameMark(mark, cluster), { once: true });
    return mark;
  }

  private async nameMark(mark: HTMLElement, { spots: [[, , index]] }: Cluster): Promise<void> {
    const [model] = await this.modelsAt([index]);
    if (model === undefined) return;
    mark.setAttribute('aria-label', model.name);
    mark.title = model.name;
  }

  /// Opens the one model that lies there; lists a few, and looks at many from nearer.
  private async choose({ spots }: Cluster): Promise<void> {
    const [[west, south]] = spots;
    const isOnePlace = spots.every(([east, north]) => east === west && north === south) || this.frame.scale >= MOST_SCALE;
    if (spots.length > FEW && !isOnePlace) {
      this.list.replaceChildren();
      this.look(frameOf(spots, this.size));
      return;
    }
    const models = await this.modelsAt(spots.slice(0, MOST_LISTED).map(([, , index]) => index));
    if (models.length === 1) visit(formatAddress({ path: models[0].path, ...NOWHERE }));
    else this.listModels(models, spots.length - models.length);
  }

  private listModels(models: readonly Model[], more: number): void {
    const links = models.map((model) => element('a', { href: formatAddress({ path: model.path, ...NOWHERE }) }, model.name));
    const rest = more > 0 ? [element('li', {}, words.gallery.mapKeys.more(formatCount(more)))] : [];
    this.list.replaceChildren(...links.map((link) => element('li', {}, link)), ...rest);
    links.at(0)?.focus();
  }
}
