// SPDX-License-Identifier: MIT
// Which attribute colours the model, and how: a legend that one can change.
import { attributeIndex, isLabel, labelColour, rampColour, RAMPS, wholeRange, type AttributeLook, type RampName, type ScalarAttribute } from '../../src/index.js';
import { formatCount, formatLength } from '../numbers.js';
import { checkbox, choice, type Control } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { words } from '../words/words.js';
import type { ViewChoices } from './view_choices.js';

const STEPS = 1000; // of a handle of the legend
const GRADIENT_STOPS = 16;
const BARS_HEIGHT = 36;

function css(colour: readonly [number, number, number]): string {
  return `rgb(${colour.join(' ')})`;
}

function gradient(ramp: RampName): string {
  const stops = Array.from({ length: GRADIENT_STOPS + 1 }, (_, i) => css(rampColour(ramp, i / GRADIENT_STOPS)));
  return `linear-gradient(to right, ${stops.join(', ')})`;
}

/// Returns the part of the whole range at which a value lies, from 0 to 1.
function partOf({ min, max }: ScalarAttribute, value: number): number {
  return Math.min(Math.max((value - min) / (max - min || 1), 0), 1);
}

/// Where the histogram's bars lie, as parts of the whole range.
function bars(attribute: ScalarAttribute): { left: number; width: number; height: number }[] {
  const { bins, firstBin, binWidth } = attribute;
  const most = Math.max(...bins, 1);
  return bins.map((count, i) => {
    const left = partOf(attribute, (firstBin + i) * binWidth);
    return { left, width: partOf(attribute, (firstBin + i + 1) * binWidth) - left, height: Math.sqrt(count / most) };
  });
}

/// A ramp with a handle at either end, the histogram above, and the numbers below.
class Legend {
  readonly root: HTMLElement;
  private readonly histogram = element('div', { class: 'histogram', 'aria-hidden': 'true' });
  private readonly strip = element('div', { class: 'ramp' });
  private readonly handles: readonly [HTMLInputElement, HTMLInputElement];
  private readonly numbers: readonly [HTMLInputElement, HTMLInputElement];
  private attribute: ScalarAttribute | null = null;

  constructor(private readonly chosen: (range: readonly [number, number]) => void) {
    const text = words.attribute;
    const names = [text.from, text.to] as const;
    const handle = (i: 0 | 1): HTMLInputElement => element('input', { type: 'range', min: '0', max: String(STEPS), step: '1', 'aria-label': names[i] });
    const number = (i: 0 | 1): HTMLInputElement => element('input', { type: 'number', step: 'any', 'aria-label': names[i], inputmode: 'decimal' });
    this.handles = [handle(0), handle(1)];
    this.numbers = [number(0), number(1)];
    for (const i of [0, 1] as const) {
      this.handles[i].addEventListener('input', () => { this.choose(i, this.valueAt(Number(this.handles[i].value) / STEPS)); });
      this.numbers[i].addEventListener('change', () => { if (!Number.isNaN(this.numbers[i].valueAsNumber)) this.choose(i, this.numbers[i].valueAsNumber); });
    }
    this.root = element('div', { class: 'legend' }, this.histogram, this.strip, element('div', { class: 'handles' }, ...this.handles), element('div', { class: 'ends' }, ...this.numbers));
  }

  private valueAt(part: number): number {
    const { min, max } = this.attribute!;
    return min + part * (max - min);
  }

  private choose(end: 0 | 1, value: number): void {
    const range: [number, number] = [this.numbers[0].valueAsNumber, this.numbers[1].valueAsNumber];
    range[end] = value;
    this.chosen(range);
  }

  show(attribute: ScalarAttribute, ramp: RampName, range: readonly [number, number]): void {
    this.attribute = attribute;
    this.strip.style.background = gradient(ramp);
    const [left, right] = [partOf(attribute, Math.min(...range)), partOf(attribute, Math.max(...range))];
    this.strip.style.marginInline = `${100 * left}% ${100 * (1 - right)}%`;
    this.strip.style.transform = range[0] > range[1] ? 'scaleX(-1)' : '';
    for (const i of [0, 1] as const) {
      this.handles[i].value = String(Math.round(STEPS * partOf(attribute, range[i])));
      this.numbers[i].value = String(Number(range[i].toPrecision(7)));
    }
    this.histogram.replaceChildren(...bars(attribute).map(({ left: x, width, height }) => {
      const bar = element('span');
      Object.assign(bar.style, { left: `${100 * x}%`, width: `${100 * width}%`, height: `${BARS_HEIGHT * height}px` });
      return bar;
    }));
  }
}

export class AttributeForm {
  readonly root: HTMLElement;
  private readonly select = element('select', { 'aria-label': words.attribute.which });
  private readonly ramp: Control<RampName>;
  private readonly isolines: Control<boolean>;
  private readonly whole = element('button', { type: 'button', class: 'text-button' }, words.attribute.wholeRange);
  private readonly legend: Legend;
  private readonly labels = element('ul', { class: 'labels' });
  private readonly quantity: HTMLElement;
  private readonly missing = element('p', { class: 'source' });
  private attributes: readonly ScalarAttribute[] = [];
  private look: AttributeLook | null = null;
  private on = false;

  constructor(private readonly choices: ViewChoices) {
    const text = words.attribute;
    const chosen = (change: Partial<AttributeLook>): void => { choices.choose({ look: change }); };
    this.select.addEventListener('change', () => { chosen({ attribute: this.select.value, range: null, hidden: [] }); });
    this.ramp = choice(text.ramp, RAMPS.map((name) => [name, name] as const), (ramp) => { chosen({ ramp }); });
    this.isolines = checkbox(text.isolines, null, (isolines) => { chosen({ isolines }); });
    this.legend = new Legend((range) => { chosen({ range }); });
    this.whole.addEventListener('click', () => { chosen({ range: null }); });
    this.quantity = element('div', { class: 'settings' }, this.legend.root, this.whole, this.ramp.root, this.isolines.root);
    this.root = element('div', { class: 'attribute settings' }, this.select, this.missing, this.quantity, this.labels);
  }

  /// The model has these.
  tell(attributes: readonly ScalarAttribute[]): void {
    if (attributes === this.attributes) return;
    this.attributes = attributes;
    this.select.replaceChildren(...attributes.map(({ name }) => element('option', { value: name }, name)));
    if (this.look !== null) this.show(this.look, this.on);
  }

  /// `on`: the model is coloured so.
  show(look: AttributeLook, on: boolean): void {
    this.look = look;
    this.on = on;
    this.root.hidden = !on || this.attributes.length === 0;
    if (this.root.hidden) return;
    const attribute = this.attributes[attributeIndex(this.attributes, look.attribute)];
    this.select.value = attribute.name;
    this.missing.hidden = attribute.missing === 0;
    this.missing.textContent = words.attribute.missing(formatCount(attribute.missing));
    const isNamed = isLabel(attribute);
    this.quantity.hidden = isNamed;
    this.labels.hidden = !isNamed;
    if (isNamed) this.showLabels(attribute, look.hidden);
    else this.showQuantity(attribute, look);
  }

  private showQuantity(attribute: ScalarAttribute, look: AttributeLook): void {
    this.ramp.show(look.ramp);
    this.isolines.show(look.isolines);
    this.legend.show(attribute, look.ramp, look.range ?? wholeRange(attribute, look.ramp));
    this.whole.disabled = look.range === null;
  }

  /// A box for each that shows or hides it.
  private showLabels({ labels, labelNames, min, max }: ScalarAttribute, hidden: readonly number[]): void {
    if (labels.length === 0) {
      this.labels.replaceChildren(element('li', {}, words.attribute.manyLabels(formatLength(min), formatLength(max))));
      return;
    }
    const focused = [...this.labels.querySelectorAll('input')].findIndex((input) => input === document.activeElement);
    this.labels.replaceChildren(...labels.map((label, i) => {
      const box = checkbox(labelNames[i] || String(label), null, (on) => { this.choices.choose({ look: { hidden: on ? hidden.filter((each) => each !== label) : [...hidden, label] } }); });
      box.show(!hidden.includes(label));
      const swatch = element('span', { class: 'swatch', 'aria-hidden': 'true' });
      swatch.style.background = css(labelColour(i));
      box.root.prepend(swatch);
      return element('li', {}, box.root);
    }));
    this.labels.querySelectorAll('input')[focused]?.focus();
  }
}
