// What hands and keys do.
import { element } from '../parts/element.js';
import { KEY_HELP } from './keys.js';

const HAND_HELP: readonly (readonly [string, string])[] = [
  ['Drag', 'turn'],
  ['Right drag, Shift + drag, two fingers', 'move'],
  ['Wheel, pinch', 'closer, farther, to where the pointer is'],
  ['Double click, double tap', 'fly there'],
];

function rows(pairs: readonly (readonly [string, string])[]): HTMLElement[] {
  return pairs.map(([what, does]) => element('div', {}, element('dt', {}, what), element('dd', {}, does)));
}

export function help(): HTMLElement {
  return element('dl', { class: 'help' }, ...rows(HAND_HELP), ...rows(KEY_HELP));
}
