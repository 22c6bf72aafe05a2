// SPDX-License-Identifier: MIT
// By which property objects have colours, and what these mean.
import type { ObjectProperty } from '../../src/hierarchy/object_facts.js';
import type { ObjectLegend } from '../../src/tools/object_colours.js';
import { formatCount, formatPercent } from '../numbers.js';
import { element } from '../parts/element.js';
import { css, RangeLegend } from '../parts/range_legend.js';
import { words as pageWords } from '../words/words.js';
import { textButton } from './figures.js';
import { words } from './words/words.js';

const MOST_TOLD = 100; // values
const NONE = '';

type Range = readonly [number, number];

function entry({ value, count, colour }: ObjectLegend['values'][number]): HTMLElement {
  const swatch = element('span', { class: 'object-swatch', 'aria-hidden': 'true' });
  swatch.style.background = css(colour);
  const text = typeof value === 'boolean' ? (value ? words.objects.yes : words.objects.no) : String(value);
  return element('li', {}, swatch, element('span', { dir: 'auto' }, text), element('span', {}, formatCount(count)));
}

export class ObjectColouring {
  readonly root: HTMLElement;
  private readonly select: HTMLSelectElement;
  private readonly list = element('ul', { tabindex: '0' });
  private readonly range: RangeLegend;
  private readonly whole: HTMLButtonElement;
  private readonly numbers: HTMLElement;
  private readonly said = element('span', {});
  private readonly reading: HTMLElement;
  private legend: ObjectLegend | null = null;

  /// `chosen`: is told the name of a property, or null; `ranged`: where the ramp begins and ends, null: over all numbers.
  constructor(properties: readonly ObjectProperty[], chosen: (name: string | null) => void, ranged: (range: Range | null) => void) {
    const { objects: text } = words;
    this.select = element('select', { class: 'tool-select' }, element('option', { value: NONE }, text.asTheyAre), ...properties.map(({ name }) => element('option', { value: name }, name)));
    this.select.addEventListener('change', () => { chosen(this.select.value === NONE ? null : this.select.value); });
    this.range = new RangeLegend(ranged);
    this.whole = textButton(pageWords.attribute.wholeRange, () => { ranged(null); });
    this.numbers = element('div', { class: 'object-numbers' }, this.range.root, this.whole);
    this.reading = element('p', { class: 'tool-note object-reading', role: 'status', hidden: true }, this.said, textButton(text.stop, () => { chosen(null); }));
    const legend = element('div', { class: 'object-legend' }, this.reading, this.numbers, this.list);
    this.root = element('div', { class: 'tool-extra', hidden: properties.length === 0 }, element('label', { class: 'tool-field' }, text.colours, this.select), legend);
    this.show(null);
  }

  /// Null: all is read.
  tellReading(part: number | null): void {
    this.reading.hidden = part === null;
    this.said.textContent = part === null ? '' : words.objects.reading(formatPercent(part));
  }

  show(legend: ObjectLegend | null): void {
    if (legend === this.legend && legend !== null) return;
    this.legend = legend;
    const { range, whole, values } = legend ?? { range: null, whole: null, values: [] };
    this.select.value = legend?.property.name ?? NONE;
    this.numbers.hidden = range === null;
    this.list.hidden = values.length === 0;
    if (range !== null && whole !== null) this.range.show({ min: whole[0], max: whole[1], bins: [], firstBin: 0, binWidth: 0 }, { ramp: 'viridis', tolerance: null }, range);
    this.whole.hidden = range === null || (range[0] === whole?.[0] && range[1] === whole[1]);
    const others = values.length - MOST_TOLD;
    this.list.replaceChildren(...values.slice(0, MOST_TOLD).map(entry), ...(others > 0 ? [element('li', {}, words.objects.others(formatCount(others)))] : []));
  }
}
