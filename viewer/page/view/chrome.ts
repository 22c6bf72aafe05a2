// SPDX-License-Identifier: MIT
// Everything around the picture: bars, badge, sheets.
import type { Manifest } from '../../src/index.js';
import { immersionModes, type ImmersionMode } from '../../src/plugins/immersion_modes.js';
import { summaryOf } from '../info/facts.js';
import { InfoSheet } from '../info/info_sheet.js';
import { element, iconButton } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { ModeBadge } from '../parts/mode_badge.js';
import { ShareSheet } from '../share/share_sheet.js';
import type { Shared } from '../share/embed_code.js';
import { words } from '../words/words.js';
import { help } from './help.js';
import { Panel } from './panel.js';
import { SettingsForm, type Choices } from './settings_form.js';
import { Sheet, Sheets } from './sheets.js';
import type { ViewChoices } from './view_choices.js';
import type { ContextEvents, PageContext } from './page_context.js';

const ZOOM_STEP = 0.45;

export interface Orders extends Choices {
  /// Null: back leads nowhere but to the whole model.
  back: (() => void) | null;
  home: () => void;
  zoom: (logarithm: number) => void;
  tools: () => void;
  story: () => void;
  immerse: (mode: ImmersionMode) => void;
  panelShown: (open: boolean) => void;
  /// What is to be shared, as it is now.
  shared: () => Shared;
}

export class Chrome {
  readonly sheets: Sheets;
  readonly settings: Sheet;
  readonly help: Sheet;
  readonly panel: Sheet;
  readonly share: Sheet;
  readonly info: Sheet;
  private readonly story: HTMLButtonElement;
  private readonly immersions: Readonly<Record<ImmersionMode, HTMLButtonElement>>;
  private readonly badge = new ModeBadge();
  private readonly busy = element('div', { class: 'busy', 'aria-hidden': 'true' });
  private readonly form: SettingsForm;
  private readonly figures = new Panel();
  private readonly summary = element('p', { class: 'unseen', id: 'model-summary' });
  private readonly sharing = new ShareSheet();
  private readonly about = new InfoSheet();

  constructor(private readonly context: PageContext, private readonly choices: ViewChoices, orders: Orders) {
    const { root, surface, signal } = context;
    this.form = new SettingsForm(orders);
    this.settings = new Sheet('settings', words.view.settings, ICONS.sliders, [this.form.root]);
    this.panel = new Sheet('figures', words.view.figures, ICONS.chart, [this.figures.root]);
    this.help = new Sheet('help', words.view.help, ICONS.help, [help()]);
    this.share = new Sheet('share', words.share.title, ICONS.share, [this.sharing.root]);
    this.info = new Sheet('info', words.info.title, ICONS.help, [this.about.root]);
    this.story = iconButton(words.story.title, ICONS.story, orders.story);
    this.story.hidden = true;
    this.immersions = {
      'immersive-vr': iconButton(words.view.vr, ICONS.vr, () => { orders.immerse('immersive-vr'); }),
      'immersive-ar': iconButton(words.view.ar, ICONS.ar, () => { orders.immerse('immersive-ar'); }),
    };
    for (const button of Object.values(this.immersions)) button.hidden = true;
    const buttons = [this.share, this.settings, this.panel, this.help].map(({ button }) => button);
    const all = [this.info, this.share, this.settings, this.panel, this.help];
    this.sheets = new Sheets(all, [this.info, this.share, this.settings, this.help], (sheet, open) => { this.sheetChanged(sheet, open, orders); }, signal);
    surface.setAttribute('aria-describedby', this.summary.id);
    root.append(surface, this.summary, this.busy, this.topBar(orders, buttons), this.zoomBar(orders), ...all.map((sheet) => sheet.root));
    this.listen();
  }

  private listen(): void {
    const { context } = this;
    context.addEventListener('chosen', () => { this.showChosen(); });
    context.addEventListener('known', ({ manifest }) => { this.tellSource(manifest); });
    context.addEventListener('report', (report) => { this.report(report); });
    context.addEventListener('story', ({ isTold }) => { this.tellStory(isTold); });
    context.addEventListener('opened', () => { immersionModes().then((modes) => { this.tellImmersions(modes); }, () => undefined); });
  }

  private showChosen(): void {
    const { context: { around: { preferences }, view }, choices: { chosen, presentation: { shown } } } = this;
    this.form.show({ ...preferences, ...chosen }, shown.key);
    this.figures.tellTerrain(view.terrain === null ? null : shown);
  }

  /// What the device can do; of all else there is no button.
  private tellImmersions(modes: readonly ImmersionMode[]): void {
    for (const mode of modes) this.immersions[mode].hidden = false;
  }

  /// The model has a story.
  private tellStory(isTold: boolean): void {
    this.story.hidden = false;
    this.story.setAttribute('aria-pressed', String(isTold));
  }

  private report({ stats, working }: ContextEvents['report']): void {
    this.badge.show(stats.mode);
    this.busy.classList.toggle('working', working);
    if (this.panel.isOpen) this.figures.show(stats, this.context.view.settings.framesPerSecond);
  }

  private tellSource(manifest: Manifest): void {
    const { model } = this.context;
    this.figures.tellSource(manifest);
    this.form.tellAttributes(manifest.source.values);
    this.about.show(model, manifest);
    const summary = summaryOf(model, manifest);
    if (this.summary.textContent !== summary) this.summary.textContent = summary;
  }

  private topBar({ back, home, tools }: Orders, buttons: readonly HTMLElement[]): HTMLElement {
    const leave = back === null ? null : iconButton(words.view.back, ICONS.back, back);
    const title = element('h1', {}, this.titleButton());
    const whole = iconButton(words.view.whole, ICONS.home, home);
    const bar = element('div', { class: 'bar' }, whole, iconButton(words.view.tools, ICONS.tools, tools), this.story, ...Object.values(this.immersions), ...buttons);
    return element('header', { class: 'top-bar' }, element('div', { class: 'top-row' }, leave, title, bar), this.badge.root);
  }

  /// The model's name, which tells more of it.
  private titleButton(): HTMLButtonElement {
    const { button } = this.info;
    const { name } = this.context.model;
    button.replaceChildren(name);
    button.className = 'title-button';
    button.title = `${name}: ${words.info.title}`;
    button.setAttribute('aria-label', button.title);
    return button;
  }

  private zoomBar({ zoom }: Orders): HTMLElement {
    const closer = iconButton(words.view.closer, ICONS.plus, () => { zoom(-ZOOM_STEP); });
    const farther = iconButton(words.view.farther, ICONS.minus, () => { zoom(ZOOM_STEP); });
    return element('div', { class: 'bar zoom-bar' }, closer, farther);
  }

  private sheetChanged(sheet: Sheet, open: boolean, orders: Orders): void {
    this.context.root.classList.toggle('with-sheet', this.sheets.anyOpen);
    if (sheet === this.panel) orders.panelShown(open);
    if (sheet === this.share && open) this.showShared(orders);
  }

  /// The address is written when the view is asked.
  private showShared(orders: Orders): void {
    const shared = orders.shared();
    this.sharing.show(location.href, shared);
  }
}
