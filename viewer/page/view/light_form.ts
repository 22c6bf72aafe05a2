// SPDX-License-Identifier: MIT
// Light, and how the model stands.
import type { Up } from '../../src/index.js';
import { MOST_STRETCH, UPS } from '../../src/index.js';
import { LIGHTS, type LightName } from '../appearance.js';
import { checkbox, choice, slider, type Control } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { words } from '../words/words.js';
import type { Angles } from '../../src/scene/lighting.js';
import type { LightDrag } from './light_drag.js';
import { SWITCH_KEYS, type Switch, type ViewChoices } from './view_choices.js';

const DEGREE = Math.PI / 180;
const AROUND = { least: -180, most: 180, step: 5 };
const ABOVE = { least: -85, most: 85, step: 5 };
const STRETCHES = { least: 1, most: MOST_STRETCH, step: 1 };

function upSelect(chosen: (up: Up) => void): Control<Up> {
  const text = words.light;
  const options = UPS.map((up) => element('option', { value: up }, up === 'file' ? text.asStored : up.replace('-', '−').toUpperCase()));
  const select = element('select', { class: 'language' }, ...options);
  select.addEventListener('change', () => { chosen(UPS[select.selectedIndex]); });
  return { root: element('label', { class: 'language-row' }, text.up, select), show: (up) => { select.value = up; } };
}

export function switchBox(choices: ViewChoices, what: Switch): Control<boolean> {
  return checkbox(words.switches[what], SWITCH_KEYS[what], (on) => { choices.turn(what, on); });
}

export class LightForm {
  readonly root: HTMLElement;
  private readonly name: Control<LightName>;
  private readonly occlusion: Control<boolean>;
  private readonly around: Control<number>;
  private readonly above: Control<number>;
  private readonly up: Control<Up>;
  private readonly stretch: Control<number>;

  constructor(private readonly choices: ViewChoices, lightDrag: LightDrag) {
    const text = words.light;
    const turn = (change: Partial<Angles>): void => {
      const { right, up } = { ...choices.presentation.shown.key, ...change };
      choices.choose({ light: { key: [right, up] } });
    };
    this.name = choice(text.light, LIGHTS.map((name) => [name, text.names[name]]), (name) => { choices.choose({ light: { name, key: null } }); });
    this.around = slider(text.around, '°', AROUND, (degrees) => { turn({ right: degrees * DEGREE }); });
    this.above = slider(text.above, '°', ABOVE, (degrees) => { turn({ up: degrees * DEGREE }); });
    this.up = upSelect((up) => { choices.choose({ standing: { up } }); });
    this.stretch = slider(text.stretch, '×', STRETCHES, (stretch) => { choices.choose({ standing: { stretch } }); });
    this.occlusion = switchBox(choices, 'occlusion');
    const drag = checkbox(text.drag, null, (on) => { lightDrag.isChosen = on; });
    const parts = [this.name, this.occlusion, drag, this.around, this.above, this.up, this.stretch];
    this.root = element('div', { class: 'settings' }, ...parts.map(({ root }) => root));
  }

  /// As it is chosen now.
  show(): void {
    const { chosen: { light, standing: { up, stretch } }, presentation: { shown: { key } } } = this.choices;
    this.name.show(light.name);
    this.occlusion.show(light.occlusion);
    this.around.show(Math.round(key.right / DEGREE));
    this.above.show(Math.round(key.up / DEGREE));
    this.up.show(up);
    this.stretch.show(stretch);
  }
}
