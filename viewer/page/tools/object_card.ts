// SPDX-License-Identifier: MIT
// What is known of an object: its name, properties and size, each of which can be copied as it is in the table.
import type { ObjectProperty } from '../../src/hierarchy/object_facts.js';
import type { ObjectRow, ObjectValue } from '../../src/hierarchy/object_blocks.js';
import type { LengthScale } from '../../src/tools/units.js';
import { formatCount, formatNumber } from '../numbers.js';
import { copyText } from '../parts/clipboard.js';
import { element, icon } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { words } from './words/words.js';

/// A line of the card; `copied`: in full.
interface Line {
  readonly name: string;
  readonly shown: string;
  readonly copied: string;
  readonly link: string | null;
}

function line(name: string, shown: string, copied = shown): Line {
  return { name, shown, copied, link: safeLink(copied) };
}

/// The address that a text is; null: it is none that a page may lead to.
export function safeLink(text: string): string | null {
  if (!/^https?:\/\/\S+$/i.test(text)) return null;
  try {
    const { protocol, href } = new URL(text);
    return protocol === 'http:' || protocol === 'https:' ? href : null;
  } catch {
    return null;
  }
}

function told(value: ObjectValue): string {
  if (typeof value === 'boolean') return value ? words.objects.yes : words.objects.no;
  return typeof value === 'number' ? formatNumber(value) : (value ?? '–');
}

function propertyLines(properties: readonly ObjectProperty[], { values }: ObjectRow): Line[] {
  return properties.flatMap(({ name }, i) => (values[i] === null ? [] : [line(name, told(values[i]), String(values[i]))]));
}

function sizeLines({ box, area, triangles }: ObjectRow, scale: LengthScale): Line[] {
  const { objects: text } = words;
  const sides = box?.max.map((most, axis) => most - box.min[axis]) ?? [];
  const told = sides.map((side) => scale.format(side));
  const size = told.map((side, axis) => (axis < 2 ? side.slice(0, side.lastIndexOf(` ${scale.sign}`)) : side)).join(' × '); // the unit once
  return [
    ...(box === null ? [] : [line(text.size, size, sides.map((side) => side * scale.factor).join(' '))]),
    line(text.area, scale.formatArea(area), String(area * scale.factor ** 2)), line(text.triangles, formatCount(triangles), String(triangles)),
  ];
}

function valueOf({ shown, link }: Line): HTMLElement {
  const text = element('span', { class: 'object-value', dir: 'auto' }, shown);
  return link === null ? text : element('a', { class: 'object-value', href: link, target: '_blank', rel: 'noopener noreferrer' }, shown);
}

export class ObjectCard {
  readonly root: HTMLElement;
  private readonly list = element('dl', { class: 'figures tool-figures object-figures' });
  private readonly said = element('p', { class: 'tool-note', role: 'status' });

  constructor() {
    this.list.addEventListener('keydown', (event) => { this.keyed(event); });
    this.root = element('div', {}, this.list, this.said);
  }

  /// Null: nothing is picked.
  show(row: ObjectRow | null, properties: readonly ObjectProperty[], scale: LengthScale): void {
    this.said.textContent = '';
    const name = row === null ? [] : [line(words.objects.name, row.name === '' ? words.objects.noName : row.name, row.name)];
    const lines = row === null ? [] : [...name, ...propertyLines(properties, row), ...sizeLines(row, scale)];
    this.list.replaceChildren(...lines.map((each, i) => this.rowOf(each, i === 0)));
  }

  private rowOf(each: Line, isFirst: boolean): HTMLElement {
    const button = element('button', { type: 'button', class: 'object-copy', 'aria-label': words.objects.copy(each.name), title: words.objects.copy(each.name), tabindex: isFirst ? '0' : '-1' }, icon(ICONS.copy));
    button.addEventListener('click', () => void this.copy(each));
    return element('div', {}, element('dt', { dir: 'auto' }, each.name), element('dd', {}, valueOf(each), button));
  }

  private async copy({ name, copied }: Line): Promise<void> {
    const said = (await copyText(copied)) ? words.pick.copied : words.pick.notCopied;
    this.said.textContent = `${name}: ${said}`;
  }

  /// The buttons are one stop of the tab key: arrows lead from one to the next.
  private keyed(event: KeyboardEvent): void {
    const buttons = [...this.list.querySelectorAll('button')];
    const at = buttons.findIndex((button) => button === event.target);
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (at < 0 || step === undefined) return;
    const to = buttons[Math.min(Math.max(at + step, 0), buttons.length - 1)];
    buttons[at].tabIndex = -1;
    to.tabIndex = 0;
    to.focus();
    event.preventDefault();
    event.stopPropagation();
  }
}
