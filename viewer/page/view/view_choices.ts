// SPDX-License-Identifier: MIT
// The choices of a model's view: how it is shown, what the browser keeps of that, and what links say instead.
import type { Look, Settings, Standing } from '../../src/index.js';
import type { Angles } from '../../src/scene/lighting.js';
import { writeLink } from '../../src/view/view_link.js';
import { keepStanding, lastingLook, readStanding, viewOf, withChoices, type Appearance, type Light } from '../appearance.js';
import { Told } from '../story/told.js';
import { nextLight, Presentation } from './presentation.js';
import type { PageContext } from './page_context.js';

export interface ViewChange {
  readonly look?: Partial<Look>;
  readonly light?: Partial<Light>;
  readonly standing?: Partial<Standing>;
  readonly level?: number | null;
}

/// Switches in the order of their form, with their keys; null: it has none.
export const SWITCH_KEYS = { texture: 'T', relight: null, wires: 'W', points: 'P', outline: 'O', flat: 'F', cavities: 'C', occlusion: 'A' } as const;
export type Switch = keyof typeof SWITCH_KEYS;

export class ViewChoices {
  readonly presentation: Presentation;
  private readonly told = new Told(withChoices);

  constructor(private readonly context: PageContext) {
    const { view, canvas, arrival, page, signal } = context;
    this.presentation = new Presentation(view, canvas.lighting, this.wished(arrival.spot.choices));
    this.presentation.apply();
    context.addEventListener('opened', () => { this.present(); }); // what the model is may choose for it
    page.addEventListener('theme', () => { this.show(); }, { signal });
    context.addEventListener('story', ({ isTold }) => { if (!isTold) this.presentAs(this.told.end(this.chosen)); });
  }

  get chosen(): Appearance {
    return this.presentation.chosen;
  }

  /// As links have it.
  get text(): string {
    return writeLink(viewOf(this.chosen));
  }

  /// As a link says.
  follow(choices: string): void {
    this.presentAs(this.wished(choices));
  }

  /// As a note of a story wants it, on top of what was chosen before the story.
  tell(choices: string): void {
    this.presentAs(this.told.tell(choices, this.chosen));
  }

  /// Kept for other models too; but not how this one stands.
  choose({ look, light, standing, level }: ViewChange): void {
    const { context: { page, model }, chosen } = this;
    const { preferences } = page;
    this.presentation.chosen = {
      look: { ...chosen.look, ...look },
      light: { ...chosen.light, ...light },
      standing: { ...chosen.standing, ...standing },
      level: level === undefined ? chosen.level : level,
    };
    page.keep({
      look: { ...preferences.look, ...lastingLook(look ?? {}) },
      light: { ...preferences.light, ...light },
      standings: standing === undefined ? preferences.standings : keepStanding(preferences.standings, model.url, this.chosen.standing),
    });
    this.present();
    this.context.startRest();
  }

  isOn(what: Switch): boolean {
    const { look, light } = this.chosen;
    if (what === 'occlusion') return light.occlusion;
    return what === 'flat' ? look.shading === 'flat' : look[what];
  }

  turn(what: Switch, on: boolean): void {
    if (what === 'occlusion') this.choose({ light: { occlusion: on } });
    else this.choose({ look: what === 'flat' ? { shading: on ? 'flat' : 'smooth' } : { [what]: on } });
  }

  toggle(what: Switch): void {
    this.turn(what, !this.isOn(what));
  }

  nextLight(): void {
    this.choose({ light: nextLight(this.chosen.light) });
  }

  turnLight(by: Angles): void {
    this.choose({ light: this.presentation.turnedLight(by) });
  }

  setSettings(change: Partial<Settings>): void {
    const { view, page } = this.context;
    view.setSettings(change);
    page.keep({ settings: { ...page.preferences.settings, ...change } });
    this.show();
  }

  /// Tells of what is chosen, and draws it.
  show(): void {
    this.context.dispatchEvent({ type: 'chosen' });
    this.context.redraw();
  }

  private present(): void {
    this.presentation.apply();
    this.show();
  }

  private presentAs(chosen: Appearance): void {
    this.presentation.chosen = chosen;
    this.present();
  }

  /// The wishes that this browser keeps, and what a link says instead.
  private wished(choices: string): Appearance {
    const { page: { preferences: { look, light, standings } }, model } = this.context;
    return withChoices(choices, { look, light, standing: readStanding(standings[model.url]), level: null });
  }
}
