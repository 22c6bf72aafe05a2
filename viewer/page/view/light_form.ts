// SPDX-License-Identifier: MIT
// Light, and how the model stands.
import type { Standing, Up } from '../../src/index.js';
import { MOST_STRETCH, UPS } from '../../src/index.js';
import { LIGHTS, type Light, type LightName } from '../appearance.js';
import { checkbox, choice, slider, type Control } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { words } from '../words/words.js';
import type { Angles } from '../../src/scene/lighting.js';

export interface LightChoices {
  /// Whether a drag turns the light from now on, instead of the model.
  dragsLight: (does: boolean) => void;
  light: (change: Partial<Light>) => void;
  standing: (change: Partial<Standing>) => void;
}

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

export class LightForm {
  readonly root: HTMLElement;
  private readonly name: Control<LightName>;
  private readonly occlusion: Control<boolean>;
  private readonly around: Control<number>;
  private readonly above: Control<number>;
  private readonly up: Control<Up>;
  private readonly stretch: Control<number>;
  private key: Angles = { right: 0, up: 0 };

  constructor({ dragsLight, light, standing }: LightChoices) {
    const text = words.light;
    const turn = (change: Partial<Angles>): void => {
      const { right, up } = { ...this.key, ...change };
      light({ key: [right, up] });
    };
    this.name = choice(text.light, LIGHTS.map((name) => [name, text.names[name]]), (name) => { light({ name, key: null }); });
    this.around = slider(text.around, '°', AROUND, (degrees) => { turn({ right: degrees * DEGREE }); });
    this.above = slider(text.above, '°', ABOVE, (degrees) => { turn({ up: degrees * DEGREE }); });
    this.up = upSelect((up) => { standing({ up }); });
    this.stretch = slider(text.stretch, '×', STRETCHES, (stretch) => { standing({ stretch }); });
    this.occlusion = checkbox(text.occlusion, 'A', (occlusion) => { light({ occlusion }); });
    const drag = checkbox(text.drag, null, dragsLight);
    const parts = [this.name, this.occlusion, drag, this.around, this.above, this.up, this.stretch];
    this.root = element('div', { class: 'settings' }, ...parts.map(({ root }) => root));
  }

  /// `key`: where the light comes from now.
  show(light: Light, key: Angles, { up, stretch }: Standing): void {
    this.key = key;
    this.name.show(light.name);
    this.occlusion.show(light.occlusion);
    this.around.show(Math.round(key.right / DEGREE));
    this.above.show(Math.round(key.up / DEGREE));
    this.up.show(up);
    this.stretch.show(stretch);
  }
}
