// Everything around the picture: bars, badge, sheets.
import type { Manifest, Stats } from '../../src/index.js';
import { element, iconButton } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { ModeBadge } from '../parts/mode_badge.js';
import type { Preferences } from '../preferences.js';
import { words } from '../words/words.js';
import { help } from './help.js';
import { Panel } from './panel.js';
import { SettingsForm, type Choices } from './settings_form.js';
import { Sheet, Sheets } from './sheets.js';

const ZOOM_STEP = 0.45;

export interface Orders extends Choices {
  /// Null: back leads nowhere but to the whole model.
  back: (() => void) | null;
  home: () => void;
  zoom: (logarithm: number) => void;
  tools: () => void;
  panelShown: (open: boolean) => void;
}

export class Chrome {
  readonly root: HTMLElement;
  readonly sheets: Sheets;
  readonly settings: Sheet;
  readonly help: Sheet;
  readonly panel: Sheet;
  private readonly badge = new ModeBadge();
  private readonly busy = element('div', { class: 'busy', 'aria-hidden': 'true' });
  private readonly form: SettingsForm;
  private readonly figures = new Panel();

  /// `surface`: what the picture is drawn on.
  constructor(name: string, surface: HTMLElement, orders: Orders, signal: AbortSignal) {
    this.form = new SettingsForm(orders);
    this.settings = new Sheet('settings', words.view.settings, ICONS.sliders, [this.form.root]);
    this.panel = new Sheet('figures', words.view.figures, ICONS.chart, [this.figures.root]);
    this.help = new Sheet('help', words.view.help, ICONS.help, [help()]);
    const all = [this.settings, this.panel, this.help];
    this.sheets = new Sheets(all, [this.settings, this.help], (sheet, open) => { this.sheetChanged(sheet, open, orders); }, signal);
    this.root = element(
      'main',
      { class: 'view' },
      surface,
      this.busy,
      this.topBar(name, orders, all.map(({ button }) => button)),
      this.zoomBar(orders),
      ...all.map(({ root }) => root),
    );
  }

  show(preferences: Preferences): void {
    this.form.show(preferences);
  }

  /// `working`: something is on its way.
  report(stats: Stats, wanted: number, working: boolean): void {
    this.badge.show(stats.mode);
    this.busy.classList.toggle('working', working);
    if (this.panel.isOpen) this.figures.show(stats, wanted);
  }

  tellSource(manifest: Manifest): void {
    this.figures.tellSource(manifest);
  }

  private topBar(name: string, { back, home, tools }: Orders, buttons: readonly HTMLElement[]): HTMLElement {
    const leave = back === null ? null : iconButton(words.view.back, ICONS.back, back);
    const title = element('h1', { title: name }, name);
    const whole = iconButton(words.view.whole, ICONS.home, home);
    const bar = element('div', { class: 'bar' }, whole, iconButton(words.view.tools, ICONS.tools, tools), ...buttons);
    return element('header', { class: 'top-bar' }, element('div', { class: 'top-row' }, leave, title, bar), this.badge.root);
  }

  private zoomBar({ zoom }: Orders): HTMLElement {
    const closer = iconButton(words.view.closer, ICONS.plus, () => { zoom(-ZOOM_STEP); });
    const farther = iconButton(words.view.farther, ICONS.minus, () => { zoom(ZOOM_STEP); });
    return element('div', { class: 'bar zoom-bar' }, closer, farther);
  }

  private sheetChanged(sheet: Sheet, open: boolean, orders: Orders): void {
    this.root.classList.toggle('with-sheet', this.sheets.anyOpen);
    if (sheet === this.panel) orders.panelShown(open);
  }
}
