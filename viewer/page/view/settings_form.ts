// SPDX-License-Identifier: MIT
// Look, quality and theme.
import { changedSettings, type Colours, type Settings } from '../../src/scene/settings.js';
import { checkbox, choice, slider, type ChoiceControl, type Control } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { languageSelect } from '../parts/language_select.js';
import { COLOURS } from '../appearance.js';
import { MEGABYTE, RANGES, THEMES, type Theme } from '../preferences.js';
import { words } from '../words/words.js';
import { PRESETS, QUALITIES, qualityOf, type Quality } from './quality.js';
import type { Manifest } from '../../src/index.js';
import { AttributeForm } from './attribute_form.js';
import { LevelForm } from './level_form.js';
import { LightForm, switchBox } from './light_form.js';
import { SWITCH_KEYS, type Switch } from './view_choices.js';
import type { ViewParts } from './view_parts.js';

const FINER = changedSettings({}).restDetail;

/// Values in their order, with their names.
function named<Value extends string>(values: readonly Value[], names: Readonly<Record<Value, string>>): (readonly [Value, string])[] {
  return values.map((value) => [value, names[value]]);
}

export class SettingsForm {
  readonly root: HTMLElement;
  private readonly colours: ChoiceControl<Colours>;
  private readonly attribute: AttributeForm;
  private readonly theme: Control<Theme>;
  private readonly quality: Control<Quality | ''>;
  private readonly toggles: readonly (readonly [Switch, Control<boolean>])[];
  private readonly light: LightForm;
  private readonly finer: Control<boolean>;
  private readonly level: LevelForm;
  private readonly reset = element('button', { type: 'button', class: 'text-button', hidden: true }, words.firstView.reset);
  private readonly sliders: Record<Exclude<keyof Settings, 'restDetail'>, Control<number>>;

  constructor(private readonly parts: ViewParts) {
    const { choices, context } = parts;
    const { page } = context;
    context.addEventListener('chosen', () => { this.show(); });
    context.addEventListener('known', ({ manifest }) => { this.tell(manifest); });
    const text = words.settings;
    const settings = (change: Partial<Settings>): void => { choices.setSettings(change); };
    this.colours = choice(text.colours, named(COLOURS, text.colourNames), (colours) => { choices.choose({ look: { colours } }); });
    this.colours.offer('attribute', false);
    this.attribute = new AttributeForm(choices);
    this.theme = choice(text.theme, named(THEMES, words.themes), (theme) => { page.setTheme(theme); });
    this.quality = choice<Quality | ''>(text.quality, named(QUALITIES, text.qualities), (quality) => { if (quality !== '') settings(PRESETS[quality]); });
    this.toggles = (Object.keys(SWITCH_KEYS) as Switch[]).filter((what) => what !== 'occlusion').map((what) => [what, switchBox(choices, what)]);
    this.finer = checkbox(text.finer, null, (finer) => { settings({ restDetail: finer ? FINER : 1 }); });
    this.level = new LevelForm((level) => { choices.choose({ level }); });
    this.reset.addEventListener('click', () => { parts.reset(); });
    this.sliders = {
      framesPerSecond: slider(text.frameRate, text.frameRateUnit, RANGES.framesPerSecond, (framesPerSecond) => { settings({ framesPerSecond }); }),
      threshold: slider(text.threshold, text.pixels, RANGES.threshold, (threshold) => { settings({ threshold }); }),
      memoryBudget: slider(text.memory, text.megabytes, RANGES.memoryBudget, (megabytes) => { settings({ memoryBudget: megabytes * MEGABYTE }); }),
    };
    this.light = new LightForm(choices, parts.light);
    const toggles = element('div', { class: 'checks' }, ...this.toggles.map(([, { root }]) => root));
    const sliders = Object.values(this.sliders).map(({ root }) => root);
    const numbers = element('details', { class: 'numbers' }, element('summary', {}, text.numbers), ...sliders, this.finer.root, this.level.root);
    const languages = element('label', { class: 'language-row' }, words.parts.language, languageSelect(page));
    this.root = element('div', { class: 'settings' }, this.colours.root, this.attribute.root, toggles, this.light.root, this.quality.root, numbers, this.theme.root, languages, this.reset);
  }

  /// The model can be coloured by its attributes, has levels, and perhaps a first view.
  private tell(manifest: Manifest): void {
    const { values } = manifest.source;
    this.attribute.tell(values, manifest);
    this.colours.offer('attribute', values.length > 0);
    this.level.tell(manifest);
    this.reset.hidden = Object.keys(manifest.view).length === 0;
  }

  /// As it is chosen now.
  private show(): void {
    const { choices, context: { page: { preferences: { settings, theme } } } } = this.parts;
    const { look, level } = choices.chosen;
    this.level.show(level);
    this.light.show();
    this.colours.show(look.colours);
    this.attribute.show(look, look.colours === 'attribute');
    this.theme.show(theme);
    this.quality.show(qualityOf(settings) ?? '');
    for (const [what, toggle] of this.toggles) toggle.show(choices.isOn(what));
    this.finer.show(settings.restDetail > 1);
    this.sliders.framesPerSecond.show(settings.framesPerSecond);
    this.sliders.threshold.show(settings.threshold);
    this.sliders.memoryBudget.show(Math.round(settings.memoryBudget / MEGABYTE));
  }
}
