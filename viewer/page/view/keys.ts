// SPDX-License-Identifier: MIT
// The keyboard, as movements and commands.
import { fieldOf } from '../../src/typing.js';
import { COLOURS } from '../appearance.js';
import { TOOLS, type ToolName } from '../tools/tools.js';
import type { Chrome } from './chrome.js';
import { SWITCH_KEYS, type Switch } from './view_choices.js';
import type { ViewParts } from './view_parts.js';

const TURN = 0.16; // radians
const PAN = 0.08; // of the picture's height
const ZOOM = 0.22; // of a factor's logarithm

type Act = (parts: ViewParts, chrome: Chrome, shift: boolean) => void;

function arrow(right: number, up: number): Act {
  return ({ camera }, _, shift) => { camera.moveByKey(shift ? { panRight: right * PAN, panUp: up * PAN } : { turnRight: right * TURN, turnUp: up * TURN }); };
}

const zoom = (by: number): Act => ({ camera }) => { camera.moveByKey({ zoom: by }); };
const home: Act = ({ camera }) => { camera.navigation.goHomeOrOut(); };
const colours = (number: number): Act => ({ choices }) => { choices.choose({ look: { colours: COLOURS[number] } }); };
const sheet = (name: 'panel' | 'help'): Act => (_, chrome) => { chrome[name].toggle(); };

/// Closes what lies over the view, then leaves the view itself.
const back: Act = (parts, { sheets }) => {
  if (!sheets.closeAside() && !parts.tools.back() && !sheets.closeOne() && !parts.story.back()) parts.back();
};

const tools = Object.entries(TOOLS).map(([name, { key }]): [string, Act] => [key.toLowerCase(), (parts) => void parts.tools.use(name as ToolName)]);
const switches = Object.entries(SWITCH_KEYS).flatMap(([name, key]): [string, Act][] =>
  (key === null ? [] : [[key.toLowerCase(), ({ choices }) => { choices.toggle(name as Switch); }]]));

/// A pair for each key, so that tests see one that stands twice.
export const KEYS: readonly (readonly [string, Act])[] = [
  ['ArrowLeft', arrow(-1, 0)], ['ArrowRight', arrow(1, 0)], ['ArrowUp', arrow(0, 1)], ['ArrowDown', arrow(0, -1)],
  ['+', zoom(-ZOOM)], ['=', zoom(-ZOOM)], ['-', zoom(ZOOM)], ['_', zoom(ZOOM)],
  ['Home', home], ['0', home], ['Escape', back], ['Backspace', back],
  ['1', colours(0)], ['2', colours(1)], ['3', colours(2)], ['4', colours(3)], ['5', colours(4)], ['6', colours(5)],
  ['q', ({ camera }) => { camera.toggleProjection(); }],
  ['u', ({ pair }) => { pair.shown?.next(); }], ['z', ({ pair }) => { pair.shown?.turn(); }],
  [',', ({ pair }) => { pair.shown?.moveDivider(-1); }], ['.', ({ pair }) => { pair.shown?.moveDivider(1); }],
  ['l', ({ light }) => { light.hold(); }], ['g', ({ choices }) => { choices.nextLight(); }],
  ['s', sheet('panel')], ['?', sheet('help')], ['h', sheet('help')], ...switches, ...tools,
];
const ACTS = new Map(KEYS);

/// Until the view is closed. What is typed into a field is the field's; Escape leaves it.
export function listenToKeys(parts: ViewParts, chrome: Chrome): void {
  window.addEventListener('keydown', (event) => {
    const field = fieldOf(event);
    if (event.key === 'Escape' && !event.isComposing) field?.blur();
    if (event.ctrlKey || event.altKey || event.metaKey || field !== null) return;
    const act = ACTS.get(event.key) ?? ACTS.get(event.key.toLowerCase());
    if (act === undefined) return;
    event.preventDefault();
    act(parts, chrome, event.shiftKey);
  }, { signal: parts.context.signal });
}
