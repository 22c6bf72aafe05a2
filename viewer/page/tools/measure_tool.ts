// SPDX-License-Identifier: MIT
// Distances, angles and areas along points of the surface.
import { boundsOf, measuresOf, type Measures } from '../../src/tools/measure.js';
import type { PickedPoint } from '../../src/tools/picked_point.js';
import { Coordinates } from '../../src/tools/coordinates.js';
import { PROFILE_AXES, profileCsv, profileLines, profileOf } from '../../src/tools/profile.js';
import { recordedBound } from '../../src/tools/shown_bound.js';
import { sectionSvg } from '../../src/tools/section_svg.js';
import { within } from '../../src/tools/units.js';
import type { Vector } from '../../src/tools/vectors.js';
import { checkbox } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { download } from './download.js';
import { figureList, figures, textButton } from './figures.js';
import { INNER_KEYS, isKey } from './keys.js';
import type { Mark } from './overlay.js';
import type { Tool } from './tool.js';
import { unitsForm } from './units_form.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

const MOST_POINTS = 500;
const ANGLE_DIGITS = 2;

function degrees(radians: number): number {
  return (radians * 180) / Math.PI;
}

export class MeasureTool implements Tool {
  readonly root: HTMLElement;
  private readonly list = figureList();
  private readonly clear = textButton(words.measure.clear, () => { this.drop(0); });
  private readonly saves = (['svg', 'csv'] as const).map((kind) => textButton(words.measure.profileAs[kind], () => { this.saveProfile(kind); }));
  private readonly note = element('p', { class: 'tool-note', role: 'status' });
  private readonly snap = checkbox(words.pick.snap, INNER_KEYS.snap, (on) => { this.setSnap(on); });
  private points: PickedPoint[] = [];
  private readonly ending = new AbortController();

  constructor(private readonly shop: Workshop) {
    const units = unitsForm(shop, () => { this.show(); });
    this.snap.show(shop.settings.snaps);
    this.root = element('div', {}, element('p', { class: 'tool-note' }, words.measure.hint), this.list, units, this.snap.root, ...this.saves, this.clear, this.note);
    this.show();
  }

  choose(right: number, up: number): void {
    if (this.points.length >= MOST_POINTS) return;
    const pointed = this.shop.pointing.at(right, up, this.shop.settings.snaps, this.ending.signal);
    if (pointed === null) return;
    this.points.push(pointed.shown);
    this.show();
    pointed.original.then((original) => { if (original) this.replace(pointed.shown, original); }, () => undefined);
  }

  key(key: string): boolean {
    if (key === 'Delete') this.drop(0);
    else if (isKey(key, 'snap')) this.setSnap(!this.shop.settings.snaps);
    else return false;
    return true;
  }

  undo(): boolean {
    if (this.points.length === 0) return false;
    this.drop(this.points.length - 1);
    return true;
  }

  marks(): readonly Mark[] {
    const scale = this.shop.scale();
    const { parts } = this.measures();
    const bounds = this.bounds();
    const lines = this.points.slice(1).map(({ local }, i) => ({ at: this.points[i].local, to: local, text: scale.formatWithin(parts[i], bounds.parts[i]) }));
    return [...lines, ...this.points.map(({ local }) => ({ at: local }))];
  }

  close(): void {
    this.ending.abort();
  }

  private setSnap(on: boolean): void {
    this.shop.settings.snaps = on;
    this.shop.chosen();
    this.snap.show(on);
  }

  private measures(): Measures {
    return measuresOf(this.points.map(({ point }) => point), this.shop.bench.view.upwards);
  }

  /// Smaller as points of the original come.
  private bounds(): Measures {
    return boundsOf(this.points.map(({ point }) => point), this.points.map(({ bound }) => bound));
  }

  private drop(from: number): void {
    this.points = this.points.slice(0, from);
    this.show();
  }

  private replace(shown: PickedPoint, original: PickedPoint): void {
    this.points = this.points.map((point) => (point === shown ? original : point));
    this.show();
  }

  /// Of what is drawn.
  private saveProfile(kind: 'svg' | 'csv'): void {
    const { bench, settings } = this.shop;
    const { view } = bench;
    const { upwards } = view;
    const coordinates = new Coordinates(view.manifest!);
    const toInput = (point: Vector): Vector => coordinates.toInput(point);
    const profiles = profileOf(view.surface, this.points.map(({ local }) => local), upwards);
    this.note.textContent = profiles.length === 0 ? words.measure.noProfile : '';
    if (profiles.length === 0) return;
    const bound = Math.max(...view.surface.map(({ node }) => recordedBound(view.source, node)));
    const scale = this.shop.scale();
    const off = bound > 0 && bound < Infinity ? `; ± ${scale.format(bound)}` : '';
    const title = `${words.measure.profile(bench.name, scale.format(this.measures().level))}${off}`;
    const text = kind === 'csv' ? profileCsv(profiles, toInput, upwards) : sectionSvg(profileLines(profiles, toInput, upwards), { axes: PROFILE_AXES, unit: settings.modelUnit, title });
    download(new Blob([text], { type: kind === 'csv' ? 'text/csv' : 'image/svg+xml' }), `${bench.name}-profile.${kind}`);
    this.note.textContent = title;
  }

  private show(): void {
    for (const save of this.saves) save.hidden = this.points.length < 2;
    const [is, off] = [this.measures(), this.bounds()];
    const scale = this.shop.scale();
    const { measure } = words;
    const lengths = (['length', 'level', 'straight', 'rise'] as const).map((name) => [measure[name], scale.formatWithin(is[name], off[name])] as const);
    const areas = (['area', 'areaLevel'] as const).flatMap((name) => (is[name] === null ? [] : [[measure[name], scale.formatAreaWithin(is[name], off[name] ?? Infinity)] as const]));
    const angle = is.angle === null ? [] : [[measure.angle, within(`${degrees(is.angle).toFixed(ANGLE_DIGITS)}°`, degrees(off.angle ?? Infinity))] as const];
    this.list.replaceChildren(...figures([[measure.points, String(this.points.length)], ...lengths, ...angle, ...areas]));
    this.shop.bench.redraw();
  }
}

export function makeTool(shop: Workshop): Tool {
  return new MeasureTool(shop);
}
