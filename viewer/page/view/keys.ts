// SPDX-License-Identifier: MIT
// The keyboard, as movements and commands.
import { fieldOf } from '../../src/typing.js';
import type { ToolName } from '../tools/bench.js';
import { TOOL_KEYS } from '../tools/keys.js';
import type { Moves } from './glide.js';

export interface Commands {
  move(moves: Partial<Moves>): void;
  home(): void;
  back(): void;
  colours(number: number): void;
  tool(name: ToolName): void;
  /// L went down.
  light(): void;
  nextLight(): void;
  toggle(what: 'texture' | 'wires' | 'points' | 'outline' | 'cavities' | 'occlusion' | 'flat' | 'panel' | 'settings' | 'help'): void;
}

const TURN = 0.16; // radians
const PAN = 0.08; // of the picture's height
const ZOOM = 0.22; // of a factor's logarithm

type Act = (commands: Commands, shift: boolean) => void;

function arrow(right: number, up: number): Act {
  return (commands, shift) => {
    commands.move(shift ? { panRight: right * PAN, panUp: up * PAN } : { turnRight: right * TURN, turnUp: up * TURN });
  };
}

const closer: Act = (commands) => { commands.move({ zoom: -ZOOM }); };
const farther: Act = (commands) => { commands.move({ zoom: ZOOM }); };
const home: Act = (commands) => { commands.home(); };
const back: Act = (commands) => { commands.back(); };
const colours = (number: number): Act => (commands) => { commands.colours(number); };
const toggle = (what: Parameters<Commands['toggle']>[0]): Act => (commands) => { commands.toggle(what); };

const TOOLS = Object.entries(TOOL_KEYS).map(([name, key]): [string, Act] => [key.toLowerCase(), (commands) => { commands.tool(name as ToolName); }]);

const VIEW: Record<string, Act> = {
  ArrowLeft: arrow(-1, 0), ArrowRight: arrow(1, 0), ArrowUp: arrow(0, 1), ArrowDown: arrow(0, -1),
  '+': closer, '=': closer, '-': farther, _: farther,
  Home: home, '0': home, Escape: back, Backspace: back,
  '1': colours(0), '2': colours(1), '3': colours(2), '4': colours(3), '5': colours(4), '6': colours(5),
  t: toggle('texture'), w: toggle('wires'), p: toggle('points'), o: toggle('outline'), f: toggle('flat'),
  s: toggle('panel'), l: (commands) => { commands.light(); }, g: (commands) => { commands.nextLight(); }, c: toggle('cavities'), a: toggle('occlusion'), '?': toggle('help'), h: toggle('help'),
};

export const VIEW_KEYS = Object.keys(VIEW);
const ACTS: Record<string, Act> = { ...Object.fromEntries(TOOLS), ...VIEW };

/// Until `signal` aborts. What is typed into a field is the field's; Escape leaves it.
export function listenToKeys(commands: Commands, signal: AbortSignal): void {
  window.addEventListener('keydown', (event) => {
    const field = fieldOf(event);
    if (event.key === 'Escape' && !event.isComposing) field?.blur();
    if (event.ctrlKey || event.altKey || event.metaKey || field !== null) return;
    const act = ACTS[event.key] ?? ACTS[event.key.toLowerCase()];
    if (act === undefined) return;
    event.preventDefault();
    act(commands, event.shiftKey);
  }, { signal });
}
