// SPDX-License-Identifier: MIT
// Look, quality and theme.
import { changedSettings, type Colours, type Look, type Settings } from '../../src/scene/settings.js';
import { checkbox, choice, slider, type Choice, type Control } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { languageSelect } from '../parts/language_select.js';
import { COLOURS, type Appearance } from '../appearance.js';
import { MEGABYTE, RANGES, THEMES, type Preferences, type Theme } from '../preferences.js';
import type { Language } from '../words/languages.js';
import { words } from '../words/words.js';
import { PRESETS, QUALITIES, qualityOf, type Quality } from './quality.js';
import type { ScalarAttribute } from '../../src/index.js';
import { AttributeForm } from './attribute_form.js';
import { LightForm, type LightChoices } from './light_form.js';
import type { Angles } from '../../src/scene/lighting.js';

export interface Choices extends LightChoices {
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
  private readonly colours: Choice<Colours>;
  private readonly attribute: AttributeForm;
  private readonly theme: Control<Theme>;
  private readonly quality: Control<Quality | ''>;
  private readonly toggles: Record<'texture' | 'relight' | 'flat' | 'wires' | 'points' | 'outline' | 'cavities', Control<boolean>>;
  private readonly light: LightForm;
  private readonly finer: Control<boolean>;
  private readonly sliders: Record<Exclude<keyof Settings, 'restDetail'>, Control<number>>;

  constructor({ look, settings, theme, language, dragsLight, light, standing }: Choices) {
    const text = words.settings;
    this.colours = choice(text.colours, named(COLOURS, text.colourNames), (colours) => { look({ colours }); });
    this.colours.offer('attribute', false);
    this.attribute = new AttributeForm(look);
    this.theme = choice(text.theme, named(THEMES, words.themes), theme);
    this.quality = choice<Quality | ''>(text.quality, named(QUALITIES, text.qualities), (quality) => { if (quality !== '') settings(PRESETS[quality]); });
    this.toggles = {
      texture: checkbox(text.texture, 'T', (texture) => { look({ texture }); }),
      relight: checkbox(words.light.relight, null, (relight) => { look({ relight }); }),
      wires: checkbox(text.wires, 'W', (wires) => { look({ wires }); }),
      points: checkbox(text.points, 'P', (points) => { look({ points }); }),
      outline: checkbox(text.outline, 'O', (outline) => { look({ outline }); }),
      flat: checkbox(text.flat, 'F', (flat) => { look({ shading: flat ? 'flat' : 'smooth' }); }),
      cavities: checkbox(words.light.cavities, 'C', (cavities) => { look({ cavities }); }),
    };
    this.finer = checkbox(text.finer, null, (finer) => { settings({ restDetail: finer ? FINER : 1 }); });
    this.sliders = {
      framesPerSecond: slider(text.frameRate, text.frameRateUnit, RANGES.framesPerSecond, (framesPerSecond) => { settings({ framesPerSecond }); }),
      threshold: slider(text.threshold, text.pixels, RANGES.threshold, (threshold) => { settings({ threshold }); }),
      memoryBudget: slider(text.memory, text.megabytes, RANGES.memoryBudget, (megabytes) => { settings({ memoryBudget: megabytes * MEGABYTE }); }),
    };
    this.light = new LightForm({ dragsLight, light, standing });
    const toggles = element('div', { class: 'checks' }, ...Object.values(this.toggles).map(({ root }) => root));
    const sliders = Object.values(this.sliders).map(({ root }) => root);
    const numbers = element('details', { class: 'numbers' }, element('summary', {}, text.numbers), ...sliders, this.finer.root);
    const languages = element('label', { class: 'language-row' }, words.parts.language, languageSelect(language));
    this.root = element('div', { class: 'settings' }, this.colours.root, this.attribute.root, toggles, this.light.root, this.quality.root, numbers, this.theme.root, languages);
  }

  /// What the model can be coloured by.
  tellAttributes(attributes: readonly ScalarAttribute[]): void {
    this.attribute.tell(attributes);
    this.colours.offer('attribute', attributes.length > 0);
  }

  /// `key`: where the light comes from.
  show({ look, settings, theme, light, standing }: Preferences & Appearance, key: Angles): void {
    this.light.show(light, key, standing);
    this.colours.show(look.colours);
    this.attribute.show(look, look.colours === 'attribute');
    this.theme.show(theme);
    this.quality.show(qualityOf(settings) ?? '');
    this.toggles.flat.show(look.shading === 'flat');
    for (const key of ['texture', 'relight', 'wires', 'points', 'outline', 'cavities'] as const) this.toggles[key].show(look[key]);
    this.finer.show(settings.restDetail > 1);
    this.sliders.framesPerSecond.show(settings.framesPerSecond);
    this.sliders.threshold.show(settings.threshold);
    this.sliders.memoryBudget.show(Math.round(settings.memoryBudget / MEGABYTE));
  }
}
