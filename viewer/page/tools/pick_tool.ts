// SPDX-License-Identifier: MIT
// Coordinates of a point, as the input has them.
import { Vector3 } from 'three';
import { Coordinates } from '../../src/tools/coordinates.js';
import { figure } from '../../src/tools/number_text.js';
import { placedPoint, type PickedPoint } from '../../src/tools/picked_point.js';
import { UNITS } from '../../src/tools/units.js';
import { distanceOf } from '../../src/tools/vectors.js';
import { rounded } from '../../src/view/kinds.js';
import { readLink, writeLink } from '../../src/view/view_link.js';
import { formatFloat, writeDecimal } from '../numbers.js';
import { copyText } from '../parts/clipboard.js';
import { checkbox } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { FigureList, line, textButton, type Figure } from './figures.js';
import { INNER_KEYS, isKey } from './keys.js';
import { pairRows } from './pair_rows.js';
import type { Mark } from '../../src/plugins/overlay.js';
import type { Tool } from './tool.js';
import type { ToolSettings } from './tool_settings.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

const NORMAL_PLACE = -4;
const LEAST_PLACES = { degrees: -9, height: -4 };
const METRES_A_DEGREE = 111_320; // at the equator
const NEAR = 1e-6; // of the model's size: rounding leaves a place of a link so near

type State = 'refining' | 'done' | 'missing';

const AXES = ['x', 'y', 'z'] as const;

/// To the digits that mean something, in the model's unit if that is known.
function coordinateRows({ point, places, bound, isOriginal }: PickedPoint, { modelUnit }: ToolSettings): Figure[] {
  const sign = modelUnit === 'unit' ? '' : ` ${UNITS[modelUnit].sign}`;
  const off = isOriginal ? 0 : bound;
  return AXES.map((name, i) => line(name, `${figure(point[i], { bound: off, place: places[i], write: writeDecimal })}${sign}`, point[i]));
}

/// To the place of the coordinates, which is so many metres.
function globeRows({ globe, places }: PickedPoint, metresPerUnit: number): Figure[] {
  if (globe === null) return [];
  const { longitude, latitude, height } = globe;
  const metres = 10 ** Math.max(...places) * metresPerUnit;
  const told = (value: number, step: number, least: number): string => figure(value, { place: Math.max(Math.floor(Math.log10(step)), least), write: writeDecimal });
  const degrees = (value: number): string => `${told(value, metres / METRES_A_DEGREE, LEAST_PLACES.degrees)}°`;
  return [
    line(words.pick.longitude, degrees(longitude), longitude),
    line(words.pick.latitude, degrees(latitude), latitude),
    line(words.pick.height, `${told(height, metres, LEAST_PLACES.height)} m`, height),
  ];
}

/// As the tiles have them: of floats.
function valueLine(name: string, { value, label }: PickedPoint['values'][number]): Figure {
  return line(name, label || (value === null ? '–' : formatFloat(value)), label || (value ?? ''));
}

function valueRows({ values }: PickedPoint): Figure[] {
  return values.map((each) => valueLine(each.name, each));
}

function originOf(picked: PickedPoint, state: State): string {
  const { isOriginal, level, index } = picked;
  if (index < 0) return words.pick.given;
  const from = isOriginal ? words.pick.original(String(index)) : words.pick.level(String(level));
  return state === 'refining' && !isOriginal ? words.pick.refining(from) : from;
}

function rowsOf(picked: PickedPoint, state: State, { settings, places }: Workshop): Figure[] {
  const isNormal = picked.normal.some((value) => value !== 0);
  const normal = picked.normal.map((value) => figure(value, { place: NORMAL_PLACE, write: writeDecimal })).join('; ');
  return [
    ...coordinateRows(picked, settings),
    ...(isNormal ? [line(words.pick.normal, normal, picked.normal.join(' '))] : []),
    ...globeRows(picked, new Coordinates(places.manifest).metresPerUnit ?? 1),
    ...valueRows(picked),
    line(words.pick.from, originOf(picked, state)),
  ];
}

export class PickTool implements Tool {
  readonly root: HTMLElement;
  private readonly list = new FigureList();
  private readonly note = element('p', { class: 'tool-note' }, words.pick.hint);
  private readonly snap = checkbox(words.pick.snap, INNER_KEYS.snap, (on) => { this.setSnap(on); });
  private readonly copy = textButton(words.pick.copy, () => void this.copyPoint());
  private picked: PickedPoint | null = null;
  private place: readonly [number, number] | null = null;
  private asking = new AbortController();

  constructor(private readonly shop: Workshop) {
    this.copy.hidden = true;
    this.snap.show(shop.settings.snaps);
    this.root = element('div', {}, this.note, this.list.root, this.snap.root, this.copy);
    shop.link('pick').onFollow(() => { this.follow(); });
    this.follow();
  }

  /// As a link says: at once the place alone, then what is there.
  private follow(): void {
    const { view } = this.shop.bench;
    const { pick } = readLink(this.shop.link('pick').text);
    this.asking.abort();
    this.place = null;
    if (pick === undefined || view.manifest === null) {
      if (this.picked !== null) this.show(null, 'done');
      return;
    }
    const placed = placedPoint(pick, view.manifest);
    this.show(placed, 'done');
    this.asking = new AbortController();
    void this.recognize(placed, this.asking.signal).catch(() => undefined);
  }

  /// The vertex that was snapped to, with all of its digits; else what the surface has at that place, as the camera sees it.
  private async recognize(placed: PickedPoint, signal: AbortSignal): Promise<void> {
    const { camera, view } = this.shop.bench;
    const { x, y } = new Vector3(...placed.local).applyMatrix4(view.surfaceMatrix).project(camera);
    const near = NEAR * view.box.min.distanceTo(view.box.max);
    for (const snaps of [true, false]) {
      const found = await this.shop.pointing.at(x, y, snaps, signal)?.original;
      if (signal.aborted || found == null) return;
      const isVertex = snaps && found.point.every((value, axis) => rounded(value) === rounded(placed.point[axis]));
      const { point, local } = placed;
      if (isVertex) this.show(found, 'done');
      else if (!snaps && distanceOf(found.point, point) <= near) this.show({ ...found, point, local }, 'done');
    }
  }

  choose(right: number, up: number): void {
    this.place = [right, up];
    void this.pick(right, up);
  }

  key(key: string): boolean {
    if (!isKey(key, 'snap')) return false;
    this.setSnap(!this.shop.settings.snaps);
    return true;
  }

  undo(): boolean {
    const had = this.picked !== null;
    this.asking.abort();
    this.place = null;
    if (had) this.show(null, 'done');
    return had;
  }

  marks(): readonly Mark[] {
    return this.picked ? [{ at: this.picked.local }] : [];
  }

  close(): void {
    this.asking.abort();
  }

  /// The place chosen last is looked at again, if the camera has not moved since.
  private setSnap(on: boolean): void {
    this.shop.setSettings({ snaps: on });
    this.snap.show(on);
    if (this.place !== null) this.choose(...this.place);
  }

  private async pick(right: number, up: number): Promise<void> {
    this.asking.abort();
    this.asking = new AbortController();
    const { signal } = this.asking;
    const pointed = this.shop.pointing.at(right, up, this.shop.settings.snaps, signal);
    this.show(pointed?.shown ?? null, 'refining');
    if (pointed === null) return;
    const original = await pointed.original.catch(() => null);
    if (!signal.aborted) this.show(original ?? pointed.shown, original ? 'done' : 'missing');
  }

  private show(picked: PickedPoint | null, state: State): void {
    this.picked = picked;
    this.shop.link('pick').write(writeLink({ pick: picked?.point }));
    this.list.show(picked ? [...rowsOf(picked, state, this.shop), ...this.beside(picked)] : []);
    this.copy.hidden = picked === null;
    this.copy.textContent = words.pick.copy;
    this.note.textContent = picked === null ? words.pick.hint : picked.isExact ? words.pick.exact : state === 'missing' ? words.pick.notThere : '';
    this.shop.bench.redraw();
  }

  /// What a second model in the picture has there.
  private beside(picked: PickedPoint): Figure[] {
    const { bench, scale } = this.shop;
    const { arrival: { other }, model } = bench.context;
    return other === null ? [] : pairRows(picked, [model.name, other.name], scale, valueLine);
  }

  private async copyPoint(): Promise<void> {
    if (this.picked === null) return;
    const isCopied = await copyText(this.picked.point.map((value, i) => line(AXES[i], '', value).copied).join(' '));
    this.copy.textContent = isCopied ? words.pick.copied : words.pick.notCopied;
  }
}

export function makeTool(shop: Workshop): Tool {
  return new PickTool(shop);
}
