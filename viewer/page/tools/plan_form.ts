// SPDX-License-Identifier: MIT
// The controls of drawings: what is chosen in them, and that it has changed.
import { roundInterval } from '../../src/tools/contours.js';
import { DRAWING_SIDES, type DrawingSide } from '../../src/tools/drawing_side.js';
import { UNIT_NAMES, UNITS, type UnitName } from '../../src/tools/units.js';
import { checkbox, choice, slider } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { PlanSheet, type PlanChoices } from './plan_sheet.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

const SCALES = [10, 20, 50, 100, 200, 500];
const DENSITIES = [150, 300, 600];
const STEPS = 500; // of a slider
const CUT_METRES = 1.2; // above the floor, as plans of houses have it

type Mutable<T> = { -readonly [K in keyof T]: T[K] };

function select<Value extends string>(name: string, options: readonly (readonly [Value, string])[], value: Value, chosen: (value: Value) => void): HTMLElement {
  const box = element('select', { class: 'tool-select' }, ...options.map(([each, text]) => element('option', { value: each }, text)));
  box.value = value;
  box.addEventListener('change', () => { chosen(box.value as Value); });
  return element('label', { class: 'tool-field' }, name, box);
}

/// `suggested`: numbers that a list offers. One that is none leaves what was chosen.
function number(name: string, suggested: readonly number[], value: number, chosen: (value: number) => void): { root: HTMLElement; show(value: number): void } {
  const list = element('datalist', { id: `plan-${name.replace(/\W/g, '')}` }, ...suggested.map((each) => element('option', { value: String(each) })));
  const input = element('input', { type: 'number', class: 'tool-number', min: '0', step: 'any', inputmode: 'decimal', list: list.id });
  let last = value;
  const show = (shown: number): void => { input.value = String(shown); last = shown; };
  show(value);
  input.addEventListener('change', () => {
    const given = input.valueAsNumber;
    if (!(given > 0) || !Number.isFinite(given)) {
      show(last);
      return;
    }
    last = given;
    chosen(given);
  });
  return { root: element('label', { class: 'tool-field' }, name, input, list), show };
}

export class PlanForm {
  readonly root: HTMLElement;
  private readonly chosen: Mutable<PlanChoices> = { side: 'plan', isPart: false, cutAt: null, scale: 100, dotsPerInch: 300, hasGrid: true, interval: null };
  private readonly cutBox = checkbox(words.plan.cut, null, (on) => { this.setCut(on); });
  private position = element('div', {});
  private readonly interval: ReturnType<typeof number>;
  private readonly contourBox: ReturnType<typeof checkbox>;
  private intervalWanted: number;

  /// `turned`: another side is looked at; `changed`: anything else.
  constructor(private readonly shop: Workshop, private readonly turned: () => void, private readonly changed: () => void) {
    const { plan } = words;
    const { least, most } = this.heightRange();
    this.intervalWanted = roundInterval(most - least);
    const sides = choice(plan.side, DRAWING_SIDES.map((side): [DrawingSide, string] => [side, plan.sides[side]]), (side) => { this.setSide(side); });
    const area = choice(plan.area, Object.entries(plan.areas) as ['whole' | 'part', string][], (which) => { this.set({ isPart: which === 'part' }); });
    this.interval = number(plan.interval, [], this.intervalWanted, (value) => {
      this.intervalWanted = value;
      if (this.chosen.interval !== null) this.set({ interval: value });
    });
    this.contourBox = checkbox(plan.contours, null, (on) => { this.setContours(on); });
    const grid = checkbox(plan.grid, null, (hasGrid) => { this.set({ hasGrid }); });
    sides.show('plan');
    area.show('whole');
    grid.show(true);
    sides.root.classList.add('plan-sides');
    const cut = element('div', { class: 'tool-form tool-plane' }, this.cutBox.root, this.position);
    const paper = element('div', { class: 'tool-form tool-extra' }, area.root, this.unitSelect(), number(plan.scale, SCALES, this.chosen.scale, (scale) => { this.set({ scale }); }).root, this.densitySelect(), grid.root);
    const contours = element('div', { class: 'tool-form tool-extra' }, this.contourBox.root, this.interval.root);
    this.interval.root.hidden = true;
    this.root = element('div', { class: 'tool-form' }, sides.root, cut, paper, contours);
    this.makePosition();
  }

  get choices(): PlanChoices {
    return { ...this.chosen };
  }

  /// Nothing is cut, and no contours are shown.
  end(): void {
    this.cutBox.show(false);
    this.contourBox.show(false);
    this.setContours(false);
    this.setCut(false);
  }

  private heightRange(): { least: number; most: number } {
    const [least, most] = new PlanSheet(this.shop, { ...this.chosen, side: 'plan' }).depthRange;
    return { least, most };
  }

  private set(change: Partial<PlanChoices>): void {
    Object.assign(this.chosen, change);
    this.changed();
  }

  private setSide(side: DrawingSide): void {
    this.chosen.side = side;
    this.makePosition();
    if (this.chosen.cutAt !== null) this.setCut(true);
    this.turned();
    this.changed();
  }

  private setCut(on: boolean): void {
    this.position.hidden = !on;
    this.set({ cutAt: on ? this.firstCut() : null });
  }

  private setContours(on: boolean): void {
    this.interval.root.hidden = !on;
    this.set({ interval: on ? this.intervalWanted : null });
  }

  /// A slider for the axis that leads to the viewer.
  private makePosition(): void {
    const sheet = new PlanSheet(this.shop, this.chosen);
    const [least, most] = sheet.depthRange;
    const made = slider(words.plan.cutAt(sheet.depthAxis.name), UNITS[this.shop.settings.modelUnit].metres === null ? '' : UNITS[this.shop.settings.modelUnit].sign, { least, most, step: (most - least) / STEPS || 1 }, (cutAt) => { this.set({ cutAt }); });
    made.show(this.firstCut());
    made.root.hidden = this.chosen.cutAt === null;
    this.position.replaceWith(made.root);
    this.position = made.root as HTMLDivElement;
  }

  /// A plan is cut above the floor where that is known to be; else there is the middle.
  private firstCut(): number {
    const sheet = new PlanSheet(this.shop, this.chosen);
    const [least, most] = sheet.depthRange;
    const { sign } = sheet.depthAxis;
    const above = CUT_METRES / (sheet.metres ?? Infinity);
    return this.chosen.side === 'plan' && above > 0 && above < most - least ? (sign > 0 ? least + above : most - above) : (least + most) / 2;
  }

  private unitSelect(): HTMLElement {
    const units = UNIT_NAMES.map((unit): [UnitName, string] => [unit, unit === 'unit' ? words.units.unknown : UNITS[unit].sign]);
    return select(words.units.model, units, this.shop.settings.modelUnit, (modelUnit) => {
      this.shop.setSettings({ modelUnit });
      this.makePosition();
      if (this.chosen.cutAt !== null) this.setCut(true);
      this.changed();
    });
  }

  private densitySelect(): HTMLElement {
    return select(words.plan.density, DENSITIES.map((each): [string, string] => [String(each), String(each)]), String(this.chosen.dotsPerInch), (value) => { this.set({ dotsPerInch: Number(value) }); });
  }
}
