// SPDX-License-Identifier: MIT
// A ramp of colours with numbers at its ends that one can change.
import { rampColour, type RampName, type ScalarAttribute } from '../../src/index.js';
import { words } from '../words/words.js';
import { element } from './element.js';

/// A range of numbers, with its histogram, if any.
export type Spread = Pick<ScalarAttribute, 'min' | 'max' | 'bins' | 'firstBin' | 'binWidth'>;

const STEPS = 1000; // of a handle of the legend
const GRADIENT_STOPS = 16;
const BARS_HEIGHT = 36;

export function css(colour: readonly [number, number, number]): string {
  return `rgb(${colour.join(' ')})`;
}

function gradient(ramp: RampName): string {
  const stops = Array.from({ length: GRADIENT_STOPS + 1 }, (_, i) => css(rampColour(ramp, i / GRADIENT_STOPS)));
  return `linear-gradient(to right, ${stops.join(', ')})`;
}

/// Returns the part of the whole range at which a value lies, from 0 to 1.
function partOf({ min, max }: Spread, value: number): number {
  return Math.min(Math.max((value - min) / (max - min || 1), 0), 1);
}

/// Where the histogram's bars lie, as parts of the whole range.
function bars(attribute: Spread): { left: number; width: number; height: number }[] {
  const { bins, firstBin, binWidth } = attribute;
  const most = Math.max(...bins, 1);
  return bins.map((count, i) => {
    const left = partOf(attribute, (firstBin + i) * binWidth);
    return { left, width: partOf(attribute, (firstBin + i + 1) * binWidth) - left, height: Math.sqrt(count / most) };
  });
}

/// A ramp with a handle at either end, the histogram above, and the numbers below.
export class RangeLegend {
  readonly root: HTMLElement;
  private readonly histogram = element('div', { class: 'histogram', 'aria-hidden': 'true' });
  private readonly strip = element('div', { class: 'ramp' });
  private readonly handles: readonly [HTMLInputElement, HTMLInputElement];
  private readonly numbers: readonly [HTMLInputElement, HTMLInputElement];
  private attribute: Spread | null = null;

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

  show(attribute: Spread, ramp: RampName, range: readonly [number, number]): void {
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
