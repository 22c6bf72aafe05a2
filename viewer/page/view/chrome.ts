// SPDX-License-Identifier: MIT
// Everything around the picture: bars, badge, sheets.
import type { Manifest, Mode } from '../../src/index.js';
import { immersionModes, type ImmersionMode } from '../../src/plugins/immersion_modes.js';
import { InfoSheet, summaryOf } from '../info/facts.js';
import { element, iconButton } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { ShareSheet } from '../share/share_sheet.js';
import { words } from '../words/words.js';
import { Panel } from './panel.js';
import type { ContextEvents } from './page_context.js';
import { SettingsForm } from './settings_form.js';
import { Sheet, Sheets } from './sheets.js';
import { ViewLegend } from './view_legend.js';
import type { ViewParts } from './view_parts.js';

const ZOOM_STEP = 0.45;

function rows(pairs: readonly (readonly string[])[]): HTMLElement {
  return element('dl', { class: 'help' }, ...pairs.map(([what, does]) => element('div', {}, element('dt', {}, what), element('dd', {}, does))));
}

/// Tells what hands and keys do, and what the modes are called.
function help(): HTMLElement {
  const { hands, keys, modesTitle, modes } = words.help;
  return element('div', {}, rows([...hands, ...keys]), element('h3', { class: 'help-title' }, modesTitle), rows(modes));
}

export class Chrome {
  readonly sheets: Sheets;
  readonly help = new Sheet('help', words.view.help, ICONS.help, [help()]);
  readonly panel: Sheet;
  private readonly settings: Sheet;
  private readonly share: Sheet;
  private readonly info: Sheet;
  private readonly compare: Sheet;
  private readonly story: HTMLButtonElement;
  private readonly immersions: Readonly<Record<ImmersionMode, HTMLButtonElement>>;
  private readonly badge = element('p', { class: 'badge', 'aria-live': 'polite', 'aria-atomic': 'true' });
  private readonly busy = element('div', { class: 'busy', 'aria-hidden': 'true' });
  private readonly summary = element('p', { class: 'unseen', id: 'model-summary' });
  private readonly sharing: ShareSheet;

  constructor(private readonly parts: ViewParts) {
    const { context, story, extensions } = parts;
    const { root, surface, signal } = context;
    this.sharing = new ShareSheet(parts);
    this.settings = new Sheet('settings', words.view.settings, ICONS.sliders, [new SettingsForm(parts).root]);
    this.panel = new Sheet('figures', words.view.figures, ICONS.chart, [new Panel(parts, () => this.panel.isOpen).root]);
    this.share = new Sheet('share', words.share.title, ICONS.share, [this.sharing.root]);
    this.info = new Sheet('info', words.info.title, ICONS.help, [new InfoSheet(context).root]);
    this.compare = new Sheet('compare', words.pair.compare, ICONS.compare, [parts.pair.form]);
    this.story = iconButton(words.story.title, ICONS.story, () => { story.toggle(); });
    this.immersions = {
      'immersive-vr': iconButton(words.view.vr, ICONS.vr, () => void extensions.immerse('immersive-vr')),
      'immersive-ar': iconButton(words.view.ar, ICONS.ar, () => void extensions.immerse('immersive-ar')),
    };
    for (const button of [this.story, ...Object.values(this.immersions)]) button.hidden = true;
    const inBar = [this.compare, this.share, this.settings, this.panel, this.help];
    const all = [this.info, ...inBar];
    this.sheets = new Sheets(all, all.filter((sheet) => sheet !== this.panel), (sheet, open) => { this.sheetChanged(sheet, open); }, signal);
    surface.setAttribute('aria-describedby', this.summary.id);
    root.append(this.summary, this.busy, this.topBar(inBar), this.zoomBar(), new ViewLegend(parts).root, ...all.map((sheet) => sheet.root));
    this.listen();
  }

  private listen(): void {
    const { context } = this.parts;
    context.addEventListener('lightKey', () => { this.settings.toggle(); });
    context.addEventListener('known', ({ manifest }) => { this.summarize(manifest); });
    context.addEventListener('report', (report) => { this.report(report); });
    context.addEventListener('story', ({ isTold }) => { this.tellStory(isTold); });
    const offerImmersions = (): void => { immersionModes().then((modes) => { this.tellImmersions(modes); }, () => undefined); };
    if (context.isOpened) offerImmersions();
    else context.addEventListener('opened', offerImmersions);
  }

  /// Shows buttons for what the device can do.
  private tellImmersions(modes: readonly ImmersionMode[]): void {
    for (const mode of modes) this.immersions[mode].hidden = false;
  }

  /// The model has a story.
  private tellStory(isTold: boolean): void {
    this.story.hidden = false;
    this.story.setAttribute('aria-pressed', String(isTold));
  }

  /// Names the mode in force; the same one again is not read out again.
  private name(mode: Mode): void {
    if (mode === this.badge.dataset.mode) return;
    this.badge.dataset.mode = mode;
    this.badge.textContent = words.modes[mode];
  }

  private report({ stats, working }: ContextEvents['report']): void {
    this.name(stats.mode);
    this.busy.classList.toggle('working', working);
  }

  private summarize(manifest: Manifest): void {
    const summary = summaryOf(this.parts.context.model, manifest);
    if (this.summary.textContent !== summary) this.summary.textContent = summary;
  }

  private topBar(sheets: readonly Sheet[]): HTMLElement {
    const { parts } = this;
    const leave = parts.context.arrival.hasGallery ? iconButton(words.view.back, ICONS.back, () => { parts.back(); }) : null;
    const title = element('h1', {}, this.titleButton());
    const whole = iconButton(words.view.whole, ICONS.home, () => { parts.camera.navigation.goHomeOrOut(); });
    const tools = iconButton(words.view.tools, ICONS.tools, () => void parts.tools.use(null));
    const bar = element('div', { class: 'bar' }, whole, tools, this.story, ...Object.values(this.immersions), ...sheets.map(({ button }) => button));
    return element('header', { class: 'top-bar' }, element('div', { class: 'top-row' }, leave, title, bar), this.badge);
  }

  /// The model's name, which tells more of it.
  private titleButton(): HTMLButtonElement {
    const { button } = this.info;
    const { name } = this.parts.context.model;
    button.replaceChildren(name);
    button.className = 'title-button';
    button.title = `${name}: ${words.info.title}`;
    button.setAttribute('aria-label', button.title);
    return button;
  }

  private zoomBar(): HTMLElement {
    const { camera } = this.parts;
    const closer = iconButton(words.view.closer, ICONS.plus, () => { camera.zoomMiddle(-ZOOM_STEP); });
    const farther = iconButton(words.view.farther, ICONS.minus, () => { camera.zoomMiddle(ZOOM_STEP); });
    return element('div', { class: 'bar zoom-bar' }, closer, farther);
  }

  private sheetChanged(sheet: Sheet, open: boolean): void {
    const { parts } = this;
    parts.context.root.classList.toggle('with-sheet', this.sheets.anyOpen);
    if (sheet === this.panel) {
      parts.context.page.keep({ panel: open });
      parts.frames.reportSoon();
    } else if (sheet === this.share && open) this.sharing.show();
    else if (sheet === this.compare && open) void parts.pair.offer();
  }
}
