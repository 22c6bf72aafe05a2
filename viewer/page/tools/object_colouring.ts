// SPDX-License-Identifier: MIT
// By which property objects have colours, and what these mean.
import type { ObjectProperty } from '../../src/hierarchy/object_facts.js';
import { rampColour } from '../../src/index.js';
import type { ObjectLegend } from '../../src/tools/object_colours.js';
import { formatCount } from '../numbers.js';
import { element } from '../parts/element.js';
import { words } from './words/words.js';

const MOST_TOLD = 12; // values
const STOPS = 8; // of the ramp's picture
const NONE = '';

function css(colour: readonly number[]): string {
  return `rgb(${colour.join(' ')})`;
}

function ramp([from, to]: readonly [number, number]): HTMLElement {
  const strip = element('span', { class: 'object-ramp', 'aria-hidden': 'true' });
  strip.style.background = `linear-gradient(to right, ${Array.from({ length: STOPS + 1 }, (_, i) => css(rampColour('viridis', i / STOPS))).join(', ')})`;
  return element('p', { class: 'object-range' }, String(from), strip, String(to));
}

function entry({ value, count, colour }: ObjectLegend['values'][number]): HTMLElement {
  const swatch = element('span', { class: 'object-swatch', 'aria-hidden': 'true' });
  swatch.style.background = css(colour);
  const text = typeof value === 'boolean' ? (value ? words.objects.yes : words.objects.no) : String(value);
  return element('li', {}, swatch, element('span', {}, text), element('span', {}, formatCount(count)));
}

export class ObjectColouring {
  readonly root: HTMLElement;
  private readonly select: HTMLSelectElement;
  private readonly legend = element('div', { class: 'object-legend' });

  /// `chosen`: is told the name of a property, or null.
  constructor(properties: readonly ObjectProperty[], chosen: (name: string | null) => void) {
    const { objects: text } = words;
    this.select = element('select', { class: 'tool-select' }, element('option', { value: NONE }, text.asTheyAre), ...properties.map(({ name }) => element('option', { value: name }, name)));
    this.select.addEventListener('change', () => { chosen(this.select.value === NONE ? null : this.select.value); });
    this.root = element('div', { class: 'tool-extra', hidden: properties.length === 0 }, element('label', { class: 'tool-field' }, text.colours, this.select), this.legend);
  }

  show(legend: ObjectLegend | null): void {
    this.select.value = legend?.property.name ?? NONE;
    const others = (legend?.values.length ?? 0) - MOST_TOLD;
    const list = element('ul', {}, ...(legend?.values ?? []).slice(0, MOST_TOLD).map(entry), others > 0 ? element('li', {}, words.objects.others(formatCount(others))) : null);
    this.legend.replaceChildren(...(legend === null ? [] : [legend.range === null ? list : ramp(legend.range)]));
  }
}
