// SPDX-License-Identifier: MIT
// Controls of forms: each has a name that can be seen and heard, and tells what was chosen.
import type { Range } from '../preferences.js';
import { element } from './element.js';

let made = 0;

export interface Control<Value> {
  root: HTMLElement;
  /// Shows a value that was chosen elsewhere; tells nobody.
  show(value: Value): void;
}

/// One of several values, of which some may not be there to be chosen.
export interface ChoiceControl<Value> extends Control<Value> {
  offer(value: Value, is: boolean): void;
}

export function checkbox(name: string, key: string | null, chosen: (on: boolean) => void): Control<boolean> {
  const input = element('input', { type: 'checkbox', 'aria-keyshortcuts': key });
  input.addEventListener('change', () => { chosen(input.checked); });
  const label = element('label', { class: 'check' }, input, element('span', {}, name), key === null ? null : element('kbd', { 'aria-hidden': 'true' }, key));
  return { root: label, show: (on) => { input.checked = on; } };
}

/// `choices`: values, and what they are called.
export function choice<Value extends string>(
  name: string,
  choices: readonly (readonly [Value, string])[],
  chosen: (value: Value) => void,
): ChoiceControl<Value> {
  const group = `choice-${++made}`;
  const inputs = choices.map(([value]) => element('input', { type: 'radio', name: group, value }));
  const labels = choices.map(([, text], i) => element('label', {}, inputs[i], element('span', {}, text)));
  inputs.forEach((input, i) => { input.addEventListener('change', () => { chosen(choices[i][0]); }); });
  const root = element('fieldset', { class: 'choice' }, element('legend', {}, name), element('div', { class: 'segments' }, ...labels));
  return {
    root,
    show: (value) => { inputs.forEach((input) => { input.checked = input.value === value; }); },
    offer: (value, is) => { labels.forEach((label, i) => { if (choices[i][0] === value) label.hidden = !is; }); },
  };
}

/// A number to the digits that a slider's step has, and one more.
function shortOf(value: number, step: number): string {
  const places = step > 0 ? Math.max(1 - Math.floor(Math.log10(step)), 0) : 0;
  return String(Number(value.toFixed(Math.min(places, 100))));
}

/// A slider and a number that say the same.
export function slider(name: string, unit: string, { least, most, step }: Range, chosen: (value: number) => void): Control<number> {
  const bounds = { min: String(least), max: String(most), step: String(step) };
  const id = `slider-${++made}`;
  const range = element('input', { type: 'range', id, ...bounds });
  const number = element('input', { type: 'number', 'aria-label': unit === '' ? name : `${name} (${unit})`, ...bounds, step: 'any', inputmode: 'decimal' });
  const show = (value: number): void => {
    range.value = String(value);
    number.value = shortOf(value, step);
  };
  range.addEventListener('input', () => {
    number.value = shortOf(Number(range.value), step);
    chosen(Number(range.value));
  });
  number.addEventListener('change', () => {
    const given = number.valueAsNumber;
    const value = Math.min(Math.max(Number.isNaN(given) ? least : given, least), most);
    show(value);
    chosen(value);
  });
  const head = element('div', { class: 'slider-head' }, element('label', { for: id }, name), element('span', {}, number, ` ${unit}`));
  return { root: element('div', { class: 'slider' }, head, range), show };
}
