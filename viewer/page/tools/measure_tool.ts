// SPDX-License-Identifier: MIT
// Distances, angles and areas along points of the surface.
import { Measuring } from '../../src/plugins/measuring.js';
import type { Mark } from '../../src/plugins/overlay.js';
import { Coordinates } from '../../src/tools/coordinates.js';
import { PROFILE_AXES, profileCsv, profileLines, profileOf } from '../../src/tools/profile.js';
import { figure } from '../../src/tools/number_text.js';
import { recordedBound } from '../../src/tools/shown_bound.js';
import { shownSurface } from '../../src/tools/shown_triangles.js';
import { sectionSvg } from '../../src/tools/section_svg.js';
import { UNIT_NAMES, UNITS, type LengthScale, type UnitName } from '../../src/tools/units.js';
import { triplesOf, type Vector } from '../../src/tools/vectors.js';
import { readLink, writeLink } from '../../src/view/view_link.js';
import { writeDecimal } from '../numbers.js';
import { checkbox } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { download } from './download.js';
import { FigureList, line, textButton } from './figures.js';
import { INNER_KEYS, isKey } from './keys.js';
import type { Tool } from './tool.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

const ANGLE_PLACE = -2;

function degrees(radians: number): number {
  return (radians * 180) / Math.PI;
}

function select(name: string, unknown: string, value: UnitName, chosen: (unit: UnitName) => void): HTMLElement {
  const box = element('select', { class: 'tool-select' }, ...UNIT_NAMES.map((unit) => element('option', { value: unit }, unit === 'unit' ? unknown : UNITS[unit].sign)));
  box.value = value;
  box.addEventListener('change', () => { chosen(box.value as UnitName); });
  return element('label', { class: 'tool-field' }, name, box);
}

/// Makes selects of units; `changed` is called after the settings have changed.
function unitsForm(shop: Workshop, changed: () => void): HTMLElement {
  const set = (key: 'modelUnit' | 'shownUnit') => (unit: UnitName): void => {
    shop.setSettings({ [key]: unit });
    changed();
  };
  const { settings } = shop;
  return element('div', { class: 'tool-units tool-extra' },
    select(words.units.model, words.units.unknown, settings.modelUnit, set('modelUnit')),
    select(words.units.shown, words.units.asModel, settings.shownUnit, set('shownUnit')));
}

export class MeasureTool implements Tool {
  readonly root: HTMLElement;
  private readonly list = new FigureList();
  private readonly clear = textButton(words.measure.clear, () => { this.measuring.keep(0); });
  private readonly saves = (['svg', 'csv'] as const).map((kind) => textButton(words.measure.profileAs[kind], () => { this.saveProfile(kind); }));
  private readonly note = element('p', { class: 'tool-note', role: 'status' });
  private readonly snap = checkbox(words.pick.snap, INNER_KEYS.snap, (on) => { this.setSnap(on); });
  private readonly measuring: Measuring;

  constructor(private readonly shop: Workshop) {
    this.measuring = new Measuring({ name: 'page measuring', isAlone: false, tell: (length, bound) => shop.scale.formatWithin(length, bound) });
    this.measuring.addEventListener('change', () => { this.show(); });
    shop.bench.view.registerPlugin(this.measuring);
    const units = unitsForm(shop, () => { this.show(); });
    this.snap.show(shop.settings.snaps);
    this.root = element('div', {}, element('p', { class: 'tool-note' }, words.measure.hint), this.list.root, units, this.snap.root, ...this.saves, this.clear, this.note);
    shop.link('measure').onFollow(() => { this.follow(); });
    this.follow();
    this.show();
  }

  /// As a link says.
  private follow(): void {
    const { text } = this.shop.link('measure');
    if (text !== this.link) this.measuring.place(triplesOf(readLink(text).measure ?? []));
  }

  /// What links tell of it.
  private get link(): string {
    const { points } = this.measuring;
    return writeLink({ measure: points.length === 0 ? undefined : points.flatMap(({ point }) => point) });
  }

  choose(right: number, up: number): void {
    this.measuring.snaps = this.shop.settings.snaps;
    this.measuring.choose(right, up);
  }

  key(key: string): boolean {
    if (key === 'Delete') this.measuring.keep(0);
    else if (isKey(key, 'snap')) this.setSnap(!this.shop.settings.snaps);
    else return false;
    return true;
  }

  undo(): boolean {
    const { points } = this.measuring;
    if (points.length === 0) return false;
    this.measuring.keep(points.length - 1);
    return true;
  }

  marks(): readonly Mark[] {
    return this.measuring.marks();
  }

  close(): void {
    this.shop.bench.view.unregisterPlugin(this.measuring);
  }

  private setSnap(on: boolean): void {
    this.shop.setSettings({ snaps: on });
    this.snap.show(on);
  }

  /// Cuts what is drawn.
  private saveProfile(kind: 'svg' | 'csv'): void {
    const { bench, settings } = this.shop;
    const { view } = bench;
    const { upwards } = view;
    const coordinates = new Coordinates(view.manifest!);
    const toInput = (point: Vector): Vector => coordinates.toInput(point);
    const profiles = profileOf(shownSurface(view), this.measuring.points.map(({ local }) => local), upwards);
    this.note.textContent = profiles.length === 0 ? words.measure.noProfile : '';
    if (profiles.length === 0) return;
    const bound = Math.max(...view.surface.map(({ node }) => recordedBound(view.source, node)));
    const off = bound > 0 && bound < Infinity ? bound : null;
    const titleIn = (scale: LengthScale): string => `${words.measure.profile(bench.name, scale.format(this.measuring.measures().level))}${off === null ? '' : `; ± ${scale.format(off)}`}`;
    const title = titleIn(this.shop.scale.plain); // files have no language
    const text = kind === 'csv' ? profileCsv(profiles, toInput, upwards) : sectionSvg(profileLines(profiles, toInput, upwards), { axes: PROFILE_AXES, unit: settings.modelUnit, title });
    download(new Blob([text], { type: kind === 'csv' ? 'text/csv' : 'image/svg+xml' }), `${bench.name}-profile.${kind}`);
    this.note.textContent = titleIn(this.shop.scale);
  }

  private show(): void {
    this.shop.link('measure').write(this.link);
    for (const save of this.saves) save.hidden = this.measuring.points.length < 2;
    const [is, off] = [this.measuring.measures(), this.measuring.bounds()];
    const scale = this.shop.scale;
    const { measure } = words;
    const lengths = (['length', 'level', 'straight', 'rise'] as const).map((name) => line(measure[name], scale.formatWithin(is[name], off[name]), is[name] * scale.factor));
    const areas = (['area', 'areaLevel'] as const).flatMap((name) => (is[name] === null ? [] : [line(measure[name], scale.formatAreaWithin(is[name], off[name] ?? Infinity), is[name] * scale.factor ** 2)]));
    const angle = is.angle === null ? [] : [line(measure.angle, `${figure(degrees(is.angle), { bound: degrees(off.angle ?? Infinity), place: ANGLE_PLACE, write: writeDecimal })}°`, degrees(is.angle))];
    this.list.show([line(measure.points, String(this.measuring.points.length)), ...lengths, ...angle, ...areas]);
    this.shop.bench.redraw();
  }
}

export function makeTool(shop: Workshop): Tool {
  return new MeasureTool(shop);
}
