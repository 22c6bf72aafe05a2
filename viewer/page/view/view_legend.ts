// SPDX-License-Identifier: MIT
// What the colours of an attribute mean, beside the picture: there while the model is coloured by a quantity.
import { attributeIndex, isLabel, wholeRange, type ScalarAttribute } from '../../src/index.js';
import { UNITS, unitOfModel } from '../../src/tools/units.js';
import type { Manifest } from '../../src/index.js';
import { formatNumber } from '../numbers.js';
import { element } from '../parts/element.js';
import { RangeLegend } from '../parts/range_legend.js';
import { words } from '../words/words.js';
import type { ViewParts } from './view_parts.js';
import './view_legend.css';

/// What `compare` measures is a length of the model.
const LENGTHS = ['distance'];

/// The sign of the unit of an attribute's values; '': not known.
export function signOfValues({ name }: ScalarAttribute, manifest: Manifest): string {
  const unit = LENGTHS.includes(name) ? unitOfModel(manifest) : null;
  return unit === null ? '' : UNITS[unit].sign;
}

/// ± 0.01 mm; '': there is none.
export function toleranceText(tolerance: number | null, sign: string): string {
  return tolerance === null ? '' : words.attribute.within(`${formatNumber(tolerance)} ${sign}`.trim());
}

export class ViewLegend {
  readonly root: HTMLElement;
  private readonly name = element('summary', {});
  private readonly legend: RangeLegend;

  constructor(private readonly parts: ViewParts) {
    const { context, choices } = parts;
    this.legend = new RangeLegend((range) => { choices.choose({ look: { range } }); });
    this.root = element('section', { class: 'view-legend', hidden: true }, element('details', { open: true }, this.name, this.legend.root));
    for (const news of ['chosen', 'manifest'] as const) context.addEventListener(news, () => { this.show(); });
  }

  private show(): void {
    const { context: { view: { manifest } }, choices: { presentation: { shown: { look } } } } = this.parts;
    const attribute = look.colours === 'attribute' && manifest !== null ? this.quantityOf(manifest.source.values) : null;
    this.root.hidden = attribute === null;
    if (attribute === null || manifest === null) return;
    const sign = signOfValues(attribute, manifest);
    const title = sign === '' ? attribute.name : `${attribute.name}, ${sign}`;
    if (this.name.textContent !== title) {
      this.name.textContent = title;
      this.root.setAttribute('aria-label', words.attribute.legend(title));
    }
    this.legend.show(attribute, look, look.range ?? wholeRange(attribute, look.ramp), toleranceText(look.tolerance, sign));
  }

  private quantityOf(attributes: readonly ScalarAttribute[]): ScalarAttribute | null {
    const attribute = attributes.at(attributeIndex(attributes, this.parts.choices.chosen.look.attribute));
    return attribute === undefined || isLabel(attribute) ? null : attribute;
  }
}
