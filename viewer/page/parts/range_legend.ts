// SPDX-License-Identifier: MIT
// A ramp of colours with its histogram, and numbers at its ends that one can change: by dragging an end, by keys, or by writing it.
import { valueColour, type AttributeLook, type ScalarAttribute } from '../../src/index.js';
import { words } from '../words/words.js';
import { element } from './element.js';

/// A range of numbers, with its histogram, if any.
export type Spread = Pick<ScalarAttribute, 'min' | 'max' | 'bins' | 'firstBin' | 'binWidth'>;

export type RampLook = Pick<AttributeLook, 'ramp' | 'tolerance'>;

type Ends = readonly [number, number];

const STEPS = 1000; // of a handle of the legend
const GRADIENT_STOPS = 16;
const EDGE = 1e-6; // of the range: on either side of a band's edge

export function css(colour: readonly [number, number, number]): string {
  return `rgb(${colour.join(' ')})`;
}

/// Values at which the gradient has a colour of its own: at equal steps, and on both sides of the edges of the band within the tolerance.
function stopsOf([from, to]: Ends, tolerance: number | null): number[] {
  const even = Array.from({ length: GRADIENT_STOPS + 1 }, (_, i) => from + ((to - from) * i) / GRADIENT_STOPS);
  const edge = EDGE * (to - from);
  const edges = tolerance === null ? [] : [-tolerance - edge, -tolerance, tolerance, tolerance + edge].filter((value) => value > from && value < to);
  return [...even, ...edges].sort((a, b) => a - b);
}

function gradient(look: RampLook, range: Ends): string {
  const [from, to] = [Math.min(...range), Math.max(...range)];
  const stops = stopsOf([from, to], look.tolerance).map((value) => `${css(valueColour(look, range, value))} ${(100 * (value - from)) / (to - from || 1)}%`);
  return `linear-gradient(to right, ${stops.join(', ')})`;
}

/// Returns the part of the whole range at which a value lies, from 0 to 1.
function partOf({ min, max }: Spread, value: number): number {
  return Math.min(Math.max((value - min) / (max - min || 1), 0), 1);
}

interface Bar {
  /// Parts of the whole range.
  readonly left: number;
  readonly width: number;
  readonly height: number;
  readonly middle: number;
}

function bars(spread: Spread): Bar[] {
  const { bins, firstBin, binWidth } = spread;
  const most = Math.max(...bins, 1);
  return bins.map((count, i) => {
    const left = partOf(spread, (firstBin + i) * binWidth);
    return { left, width: partOf(spread, (firstBin + i + 1) * binWidth) - left, height: Math.sqrt(count / most), middle: (firstBin + i + 0.5) * binWidth };
  });
}

/// An axis on which both ends lie: values beyond the attribute's own, too.
function widened({ min, max, ...others }: Spread, range: Ends): Spread {
  return { ...others, min: Math.min(min, ...range), max: Math.max(max, ...range) };
}

export class RangeLegend {
  readonly root: HTMLElement;
  private readonly histogram = element('div', { class: 'histogram', 'aria-hidden': 'true' });
  private readonly strip = element('div', { class: 'ramp' });
  private readonly plot: HTMLElement;
  private readonly handles: readonly [HTMLInputElement, HTMLInputElement];
  private readonly numbers: readonly [HTMLInputElement, HTMLInputElement];
  private readonly band = element('span', { class: 'band' });
  private spread: Spread | null = null;
  private axis: Spread | null = null; // stays while an end is dragged
  private range: Ends = [0, 1];
  private isDiverging = false;
  private dragged: 0 | 1 | null = null;

  constructor(private readonly chosen: (range: readonly [number, number]) => void) {
    const text = words.attribute;
    const names = [text.from, text.to] as const;
    const handle = (i: 0 | 1): HTMLInputElement => element('input', { type: 'range', min: '0', max: String(STEPS), step: '1', 'aria-label': names[i] });
    const number = (i: 0 | 1): HTMLInputElement => element('input', { type: 'number', step: 'any', 'aria-label': names[i], inputmode: 'decimal' });
    this.handles = [handle(0), handle(1)];
    this.numbers = [number(0), number(1)];
    for (const i of [0, 1] as const) {
      this.handles[i].addEventListener('input', () => { this.move(i, this.valueAt(Number(this.handles[i].value) / STEPS)); });
      this.numbers[i].addEventListener('change', () => { if (!Number.isNaN(this.numbers[i].valueAsNumber)) this.choose(i, this.numbers[i].valueAsNumber); });
    }
    this.plot = element('div', { class: 'legend-plot' }, this.histogram, this.strip);
    this.listen();
    this.root = element('div', { class: 'legend' }, this.plot, element('div', { class: 'handles' }, ...this.handles), element('div', { class: 'ends' }, this.numbers[0], this.band, this.numbers[1]));
  }

  /// The nearer end goes to where the histogram is touched, and along.
  private listen(): void {
    const { plot } = this;
    plot.addEventListener('pointerdown', (event) => {
      const value = this.valueUnder(event);
      this.dragged = Math.abs(value - this.range[0]) < Math.abs(value - this.range[1]) ? 0 : 1;
      plot.setPointerCapture(event.pointerId);
      this.move(this.dragged, value);
      event.preventDefault();
    });
    plot.addEventListener('pointermove', (event) => { if (this.dragged !== null) this.move(this.dragged, this.valueUnder(event)); });
    for (const end of ['pointerup', 'pointercancel'] as const) plot.addEventListener(end, () => { this.release(); });
  }

  private release(): void {
    this.dragged = null;
    if (this.spread !== null) this.axis = widened(this.spread, this.range);
  }

  private valueUnder({ clientX }: PointerEvent): number {
    const { left, width } = this.plot.getBoundingClientRect();
    return this.valueAt(Math.min(Math.max((clientX - left) / (width || 1), 0), 1));
  }

  private valueAt(part: number): number {
    const { min, max } = this.axis!;
    return min + part * (max - min);
  }

  private choose(end: 0 | 1, value: number): void {
    const range: [number, number] = [...this.range];
    range[end] = value;
    this.chosen(range);
  }

  /// What is even on both sides of 0 stays so.
  private move(end: 0 | 1, value: number): void {
    const rounded = Number(value.toPrecision(4));
    const away = Math.abs(rounded);
    if (this.isDiverging && away > 0) this.chosen(this.range[0] < 0 ? [-away, away] : [away, -away]);
    else this.choose(end, rounded);
  }

  /// `tolerance`: as people read it, with its unit.
  show(spread: Spread, look: RampLook, range: Ends, tolerance = ''): void {
    if (this.dragged === null || this.spread !== spread) this.axis = widened(spread, range);
    [this.spread, this.range] = [spread, range];
    this.isDiverging = look.ramp === 'coolwarm' && range[0] === -range[1] && range[0] !== 0;
    const axis = this.axis!;
    this.strip.style.background = gradient(look, range);
    const [left, right] = [partOf(axis, Math.min(...range)), partOf(axis, Math.max(...range))];
    this.strip.style.marginInline = `${100 * left}% ${100 * (1 - right)}%`;
    this.band.textContent = tolerance;
    for (const i of [0, 1] as const) {
      this.handles[i].value = String(Math.round(STEPS * partOf(axis, range[i])));
      this.numbers[i].value = String(Number(range[i].toPrecision(7)));
    }
    this.histogram.replaceChildren(...bars(axis).map((bar) => this.barOf(bar, look)));
  }

  /// In the colour of its values, where they have one of the ramp's.
  private barOf({ left, width, height, middle }: Bar, look: RampLook): HTMLElement {
    const bar = element('span');
    const isWithin = middle >= Math.min(...this.range) && middle <= Math.max(...this.range);
    Object.assign(bar.style, { left: `${100 * left}%`, width: `${100 * width}%`, height: `${100 * height}%`, ...(isWithin && { background: css(valueColour(look, this.range, middle)) }) });
    return bar;
  }
}
