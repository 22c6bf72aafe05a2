// SPDX-License-Identifier: MIT
// In which unit the model is, and in which one lengths are shown.
import { UNIT_NAMES, UNITS, type UnitName } from '../../src/tools/units.js';
import { element } from '../parts/element.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

function select(name: string, unknown: string, value: UnitName, chosen: (unit: UnitName) => void): HTMLElement {
  const box = element('select', { class: 'tool-select' }, ...UNIT_NAMES.map((unit) => element('option', { value: unit }, unit === 'unit' ? unknown : UNITS[unit].sign)));
  box.value = value;
  box.addEventListener('change', () => { chosen(box.value as UnitName); });
  return element('label', { class: 'tool-field' }, name, box);
}

/// `changed`: after the settings have.
export function unitsForm(shop: Workshop, changed: () => void): HTMLElement {
  const set = (key: 'modelUnit' | 'shownUnit') => (unit: UnitName): void => {
    shop.setSettings({ [key]: unit });
    changed();
  };
  const { settings } = shop;
  return element('div', { class: 'tool-units tool-extra' },
    select(words.units.model, words.units.unknown, settings.modelUnit, set('modelUnit')),
    select(words.units.shown, words.units.asModel, settings.shownUnit, set('shownUnit')));
}
