// Look, quality and theme.
import { changedSettings, type Colours, type Look, type Settings } from '../../src/scene/settings.js';
import { checkbox, choice, slider, type Control } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { languageSelect } from '../parts/language_select.js';
import { COLOURS, MEGABYTE, RANGES, THEMES, type Preferences, type Theme } from '../preferences.js';
import type { Language } from '../words/languages.js';
import { words } from '../words/words.js';
import { PRESETS, QUALITIES, qualityOf, type Quality } from './quality.js';

export interface Choices {
  look: (change: Partial<Look>) => void;
  settings: (change: Partial<Settings>) => void;
  theme: (theme: Theme) => void;
  language: (language: Language) => void;
}

const FINER = changedSettings({}).restDetail;

/// Values in their order, with their names.
function named<Value extends string>(values: readonly Value[], names: Readonly<Record<Value, string>>): (readonly [Value, string])[] {
  return values.map((value) => [value, names[value]]);
}

export class SettingsForm {
  readonly root: HTMLElement;
  private readonly colours: Control<Colours>;
  private readonly theme: Control<Theme>;
  private readonly quality: Control<Quality | ''>;
  private readonly toggles: Record<'texture' | 'flat' | 'wires' | 'points' | 'outline', Control<boolean>>;
  private readonly finer: Control<boolean>;
  private readonly sliders: Record<Exclude<keyof Settings, 'restDetail'>, Control<number>>;

  constructor({ look, settings, theme, language }: Choices) {
    const text = words.settings;
    this.colours = choice(text.colours, named(COLOURS, text.colourNames), (colours) => { look({ colours }); });
    this.theme = choice(text.theme, named(THEMES, words.themes), theme);
    this.quality = choice<Quality | ''>(text.quality, named(QUALITIES, text.qualities), (quality) => { if (quality !== '') settings(PRESETS[quality]); });
    this.toggles = {
      texture: checkbox(text.texture, 'T', (texture) => { look({ texture }); }),
      wires: checkbox(text.wires, 'W', (wires) => { look({ wires }); }),
      points: checkbox(text.points, 'P', (points) => { look({ points }); }),
      outline: checkbox(text.outline, 'O', (outline) => { look({ outline }); }),
      flat: checkbox(text.flat, 'F', (flat) => { look({ shading: flat ? 'flat' : 'smooth' }); }),
    };
    this.finer = checkbox(text.finer, null, (finer) => { settings({ restDetail: finer ? FINER : 1 }); });
    this.sliders = {
      framesPerSecond: slider(text.frameRate, text.frameRateUnit, RANGES.framesPerSecond, (framesPerSecond) => { settings({ framesPerSecond }); }),
      threshold: slider(text.threshold, text.pixels, RANGES.threshold, (threshold) => { settings({ threshold }); }),
      memoryBudget: slider(text.memory, text.megabytes, RANGES.memoryBudget, (megabytes) => { settings({ memoryBudget: megabytes * MEGABYTE }); }),
    };
    const toggles = element('div', { class: 'checks' }, ...Object.values(this.toggles).map(({ root }) => root));
    const sliders = Object.values(this.sliders).map(({ root }) => root);
    const numbers = element('details', { class: 'numbers' }, element('summary', {}, text.numbers), ...sliders, this.finer.root);
    const languages = element('label', { class: 'language-row' }, words.parts.language, languageSelect(language));
    this.root = element('div', { class: 'settings' }, this.colours.root, toggles, this.quality.root, numbers, this.theme.root, languages);
  }

  show({ look, settings, theme }: Preferences): void {
    this.colours.show(look.colours);
    this.theme.show(theme);
    this.quality.show(qualityOf(settings) ?? '');
    this.toggles.flat.show(look.shading === 'flat');
    for (const key of ['texture', 'wires', 'points', 'outline'] as const) this.toggles[key].show(look[key]);
    this.finer.show(settings.restDetail > 1);
    this.sliders.framesPerSecond.show(settings.framesPerSecond);
    this.sliders.threshold.show(settings.threshold);
    this.sliders.memoryBudget.show(Math.round(settings.memoryBudget / MEGABYTE));
  }
}
