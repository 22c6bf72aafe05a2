// Look, quality and theme.
import type { Colours, Look, Settings } from '../../src/scene/settings.js';
import { checkbox, choice, slider, type Control } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { MEGABYTE, RANGES, type Preferences, type Theme } from '../preferences.js';

export interface Choices {
  look: (change: Partial<Look>) => void;
  settings: (change: Partial<Settings>) => void;
  theme: (theme: Theme) => void;
}

const COLOUR_NAMES: readonly (readonly [Colours, string])[] = [['plain', 'Plain'], ['vertex', 'Input'], ['partition', 'Partitions'], ['error', 'Error']];
const THEME_NAMES: readonly (readonly [Theme, string])[] = [['auto', 'Auto'], ['light', 'Light'], ['dark', 'Dark']];

export class SettingsForm {
  readonly root: HTMLElement;
  private readonly colours: Control<Colours>;
  private readonly theme: Control<Theme>;
  private readonly toggles: Record<'texture' | 'flat' | 'wires' | 'points' | 'outline', Control<boolean>>;
  private readonly sliders: Record<keyof Settings, Control<number>>;

  constructor({ look, settings, theme }: Choices) {
    this.colours = choice('Colours', COLOUR_NAMES, (colours) => { look({ colours }); });
    this.theme = choice('Theme', THEME_NAMES, theme);
    this.toggles = {
      texture: checkbox('Texture', 'T', (texture) => { look({ texture }); }),
      wires: checkbox('Wires', 'W', (wires) => { look({ wires }); }),
      points: checkbox('Points', 'P', (points) => { look({ points }); }),
      outline: checkbox('Outline', 'O', (outline) => { look({ outline }); }),
      flat: checkbox('Flat', 'F', (flat) => { look({ shading: flat ? 'flat' : 'smooth' }); }),
    };
    this.sliders = {
      framesPerSecond: slider('Frame rate to hold', 'fps', RANGES.framesPerSecond, (framesPerSecond) => { settings({ framesPerSecond }); }),
      threshold: slider('Error allowed', 'px', RANGES.threshold, (threshold) => { settings({ threshold }); }),
      memoryBudget: slider('Memory', 'MB', RANGES.memoryBudget, (megabytes) => { settings({ memoryBudget: megabytes * MEGABYTE }); }),
    };
    const toggles = element('div', { class: 'checks' }, ...Object.values(this.toggles).map(({ root }) => root));
    const sliders = Object.values(this.sliders).map(({ root }) => root);
    this.root = element('div', { class: 'settings' }, this.colours.root, toggles, ...sliders, this.theme.root);
  }

  show({ look, settings, theme }: Preferences): void {
    this.colours.show(look.colours);
    this.theme.show(theme);
    this.toggles.flat.show(look.shading === 'flat');
    for (const key of ['texture', 'wires', 'points', 'outline'] as const) this.toggles[key].show(look[key]);
    this.sliders.framesPerSecond.show(settings.framesPerSecond);
    this.sliders.threshold.show(settings.threshold);
    this.sliders.memoryBudget.show(Math.round(settings.memoryBudget / MEGABYTE));
  }
}
