// SPDX-License-Identifier: MIT
// Which attribute colours the model, and how: a legend that one can change.
import { attributeIndex, isLabel, labelColour, RAMPS, wholeRange, type AttributeLook, type Manifest, type RampName, type ScalarAttribute } from '../../src/index.js';
import { formatCount, formatFloat } from '../numbers.js';
import { checkbox, choice, type Control } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { css, RangeLegend } from '../parts/range_legend.js';
import { words } from '../words/words.js';
import { signOfValues, toleranceText } from './view_legend.js';
import type { ViewChoices } from './view_choices.js';

export class AttributeForm {
  readonly root: HTMLElement;
  private readonly select = element('select', { 'aria-label': words.attribute.which });
  private readonly ramp: Control<RampName>;
  private readonly isolines: Control<boolean>;
  private readonly tolerance = element('input', { type: 'number', min: '0', step: 'any', inputmode: 'decimal' });
  private manifest: Manifest | null = null;
  private readonly whole = element('button', { type: 'button', class: 'text-button' }, words.attribute.wholeRange);
  private readonly legend: RangeLegend;
  private readonly labels = element('ul', { class: 'labels' });
  private readonly quantity: HTMLElement;
  private readonly missing = element('p', { class: 'source' });
  private attributes: readonly ScalarAttribute[] = [];
  private look: AttributeLook | null = null;
  private on = false;

  constructor(private readonly choices: ViewChoices) {
    const text = words.attribute;
    const chosen = (change: Partial<AttributeLook>): void => { choices.choose({ look: change }); };
    this.select.addEventListener('change', () => { chosen({ attribute: this.select.value, range: null, tolerance: null, hidden: [] }); });
    this.ramp = choice(text.ramp, RAMPS.map((name) => [name, name] as const), (ramp) => { chosen({ ramp }); });
    this.isolines = checkbox(text.isolines, null, (isolines) => { chosen({ isolines }); });
    this.legend = new RangeLegend((range) => { chosen({ range }); });
    this.whole.addEventListener('click', () => { chosen({ range: null }); });
    this.tolerance.addEventListener('change', () => {
      const { valueAsNumber: tolerance } = this.tolerance;
      chosen({ tolerance: tolerance > 0 ? tolerance : null });
    });
    const band = element('label', { class: 'language-row tolerance' }, text.tolerance, this.tolerance);
    this.quantity = element('div', { class: 'settings' }, this.legend.root, this.whole, band, this.ramp.root, this.isolines.root);
    this.root = element('div', { class: 'attribute settings' }, this.select, this.missing, this.quantity, this.labels);
  }

  /// The model has these.
  tell(attributes: readonly ScalarAttribute[], manifest: Manifest): void {
    this.manifest = manifest;
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
    const sign = this.manifest === null ? '' : signOfValues(attribute, this.manifest);
    this.tolerance.value = look.tolerance === null ? '' : String(look.tolerance);
    this.legend.show(attribute, look, look.range ?? wholeRange(attribute, look.ramp), toleranceText(look.tolerance, sign));
    this.whole.disabled = look.range === null;
  }

  /// A box for each that shows or hides it.
  private showLabels({ labels, labelNames, min, max }: ScalarAttribute, hidden: readonly number[]): void {
    if (labels.length === 0) {
      this.labels.replaceChildren(element('li', {}, words.attribute.manyLabels(formatFloat(min), formatFloat(max))));
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
