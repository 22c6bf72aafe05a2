// SPDX-License-Identifier: MIT
// Plans and elevations as drawings: pictures at a scale, and lines of sections and contours as SVG, DXF and GeoJSON.
import { Clipping } from '../../src/plugins/clipping.js';
import { Contours } from '../../src/plugins/contours.js';
import type { Mark } from '../../src/plugins/overlay.js';
import { contourGeoJson } from '../../src/tools/contour_geojson.js';
import { INDEX_EVERY } from '../../src/tools/contours.js';
import { Coordinates } from '../../src/tools/coordinates.js';
import { drawingDxf } from '../../src/tools/drawing_dxf.js';
import { directionOf } from '../../src/tools/drawing_side.js';
import { drawingSvg } from '../../src/tools/drawing_svg.js';
import { lengthOfLine, type DrawnLine } from '../../src/tools/line_drawing.js';
import { coordinateText, problemOfPaper, scaleText } from '../../src/tools/paper.js';
import { roundLength } from '../../src/tools/scale_bar.js';
import { MOST_SIZE } from '../../src/tools/screenshot.js';
import { lengthOf } from '../../src/tools/section.js';
import { recordedBound } from '../../src/tools/shown_bound.js';
import { UNITS } from '../../src/tools/units.js';
import { checkbox } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { wholeView } from '../view/camera_moves.js';
import { download } from './download.js';
import { textButton } from './figures.js';
import { PlanForm } from './plan_form.js';
import { PlanSheet } from './plan_sheet.js';
import type { Tool } from './tool.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';
import './plan.css';

/// A drawing of more pixels takes more memory than a page should: A0 at 600 dpi.
const MOST_PIXELS = 6e8;
const MOST_LABELS = 60;
/// Labels in the view: none on lines shorter than this part of the model.
const LEAST_LABELLED = 0.08;

type LineFile = 'svg' | 'dxf' | 'geojson';
const TYPES: Readonly<Record<LineFile, string>> = { svg: 'image/svg+xml', dxf: 'image/vnd.dxf', geojson: 'application/geo+json' };

export class PlanTool implements Tool {
  readonly root: HTMLElement;
  private readonly clipping = new Clipping('page plan cut');
  private readonly contours = new Contours('page contours');
  private readonly form: PlanForm;
  private readonly told = element('p', { class: 'tool-note' });
  private readonly note = element('p', { class: 'tool-note', role: 'status' });
  private readonly save = textButton(words.plan.save, () => void this.work((signal) => this.savePicture(signal)));
  private readonly stop = textButton(words.plan.stop, () => { this.working.abort(); });
  private readonly files: readonly HTMLButtonElement[];
  private isOriginal = false;
  private working = new AbortController();
  private labels: readonly Mark[] = [];
  private labelled = '';

  constructor(private readonly shop: Workshop) {
    const { view } = shop.bench;
    view.registerPlugin(this.clipping);
    view.registerPlugin(this.contours);
    const { plan } = words;
    this.form = new PlanForm(shop, () => { this.turn(); }, () => { this.apply(); });
    this.files = (['svg', 'dxf', 'geojson'] as const).map((kind) => textButton(plan.files[kind], () => void this.work((signal) => this.saveLines(kind, signal))));
    const original = checkbox(plan.original, null, (on) => { this.isOriginal = on; });
    original.root.classList.add('tool-extra');
    const lines = element('div', { class: 'plan-files tool-extra' }, ...this.files);
    this.stop.hidden = true;
    this.root = element('div', {}, this.form.root, this.told, this.save, original.root, lines, this.stop, this.note);
    this.turn();
    this.apply();
  }

  marks(): readonly Mark[] {
    return this.labels;
  }

  /// Labels follow what is shown, once the view rests.
  drawn(): void {
    const { view } = this.shop.bench;
    const { interval } = this.form.choices;
    if (interval === null || !view.stats().settled) return;
    const key = [interval, view.omissionKey, ...view.surface.map(({ node: { level, index } }) => `${level}/${index}`)].join();
    if (key === this.labelled) return;
    this.labelled = key;
    this.labels = this.labelsOf(interval);
    if (this.labels.length > 0) this.shop.bench.redraw();
  }

  lasting(): string | null {
    const { cutAt, interval } = this.form.choices;
    return cutAt !== null ? words.clip.lasting : interval !== null ? words.plan.contours : null;
  }

  end(): void {
    this.form.end();
  }

  close(): void {
    this.working.abort();
    const { view } = this.shop.bench;
    for (const plugin of [this.clipping, this.contours]) view.unregisterPlugin(plugin);
  }

  private get sheet(): PlanSheet {
    return new PlanSheet(this.shop, this.form.choices);
  }

  /// Looks at the whole from the side that is drawn.
  private turn(): void {
    const { bench } = this.shop;
    bench.projection = 'parallel';
    const { clientWidth, clientHeight } = bench.surface;
    bench.fly(wholeView(bench.view.box, clientWidth / Math.max(clientHeight, 1), directionOf(this.form.choices.side), bench.view.shape(), 'parallel'));
  }

  private apply(): void {
    const { sheet, shop: { bench } } = this;
    const { plane, choices: { interval } } = sheet;
    this.note.textContent = '';
    this.clipping.cut(plane === null ? [] : [plane], true);
    if (interval === null) this.contours.hide();
    else this.contours.draw(sheet.heights, interval);
    if (interval === null) this.labels = [];
    this.labelled = '';
    this.files[2].hidden = interval === null;
    this.told.textContent = this.problem(sheet) ?? this.sizeText(sheet);
    bench.redraw();
  }

  /// Why there can be no picture; null: there can.
  private problem(sheet: PlanSheet): string | null {
    const { plan } = words;
    if (sheet.metres === null) return plan.noUnit;
    const paper = sheet.paper(this.titles(sheet), false);
    const problem = problemOfPaper(paper.inner);
    const size = sheet.size(this.titles(sheet));
    const most = Math.max(size.width, size.height);
    const over = Math.max(most / MOST_SIZE, Math.sqrt((size.width * size.height) / MOST_PIXELS));
    if (problem?.what === 'small') return plan.tooSmall(scaleText(sheet.choices.scale));
    if (problem === null && over <= 1) return null;
    return plan.tooLarge(String(size.width), String(size.height), scaleText(this.roundUp(sheet.choices.scale * over)));
  }

  private roundUp(least: number): number {
    const below = roundLength(least);
    return below >= least ? below : roundLength(below * 2.5);
  }

  private sizeText(sheet: PlanSheet): string {
    const paper = sheet.paper(this.titles(sheet), false);
    const { width, height } = sheet.size(this.titles(sheet));
    return words.plan.size(String(Math.round(paper.width)), String(Math.round(paper.height)), String(width), String(height));
  }

  /// Two lines: what is drawn, and how exactly.
  private titles(sheet: PlanSheet, isOriginal = false): string[] {
    const { plan } = words;
    const { side, scale, cutAt, interval, dotsPerInch } = sheet.choices;
    const { bench, settings } = this.shop;
    const stretch = side === 'plan' ? 1 : bench.view.standing.stretch;
    const parts = [bench.name, plan.sides[side], scaleText(scale)];
    if (cutAt !== null) parts.push(plan.cutTold(sheet.depthAxis.name, `${Number(cutAt.toPrecision(6))} ${UNITS[settings.modelUnit].sign}`));
    if (interval !== null && side === 'plan') parts.push(plan.contoursTold(`${interval} ${UNITS[settings.modelUnit].sign}`));
    if (stretch !== 1 && !isOriginal) parts.push(plan.stretched(String(stretch)));
    return [parts.join(' · '), isOriginal ? plan.fromOriginal : `${this.shownTold()} · ${dotsPerInch} dpi`];
  }

  private shownTold(): string {
    const { view } = this.shop.bench;
    const levels = view.surface.map(({ node }) => node.level);
    const bound = Math.max(0, ...view.surface.map(({ node }) => recordedBound(view.source, node)));
    const told = words.clip.levels(String(Math.min(...levels)), String(Math.max(...levels)), String(view.source?.tree.lastLevel ?? 0));
    return bound > 0 && bound < Infinity ? `${told} · ± ${Number(bound.toPrecision(2))} ${UNITS[this.shop.settings.modelUnit].sign}` : told;
  }

  // ---- files

  /// One thing at a time.
  private async work(task: (signal: AbortSignal) => Promise<string>): Promise<void> {
    this.working.abort();
    const working = new AbortController();
    this.working = working;
    const buttons = [this.save, ...this.files];
    for (const button of buttons) button.disabled = true;
    this.stop.hidden = false;
    this.note.textContent = words.plan.working;
    try {
      this.note.textContent = await task(working.signal);
    } catch (problem) {
      this.note.textContent = working.signal.aborted ? '' : words.plan.failed(problem instanceof Error ? problem.message : String(problem));
    } finally {
      for (const button of buttons) button.disabled = false;
      this.stop.hidden = true;
    }
  }

  private readonly progress = (done: number, all: number): void => { this.note.textContent = words.plan.progress(String(done), String(all)); };

  private async savePicture(signal: AbortSignal): Promise<string> {
    const { sheet } = this;
    const problem = this.problem(sheet);
    if (problem !== null) return problem;
    this.contours.hide(); // the drawing has its own, in its own widths
    try {
      const picture = await sheet.takePicture(() => this.titles(sheet), { signal, progress: this.progress });
      signal.throwIfAborted();
      download(picture, `${this.fileName(sheet)}.png`);
      return '';
    } finally {
      this.apply();
    }
  }

  private fileName(sheet: PlanSheet): string {
    return `${this.shop.bench.name}-${sheet.choices.side}-${scaleText(sheet.choices.scale).replace(':', '-')}`;
  }

  private async saveLines(kind: LineFile, signal: AbortSignal): Promise<string> {
    const { sheet } = this;
    if (kind === 'svg' && sheet.metres === null) return words.plan.noUnit;
    if (sheet.choices.cutAt === null && sheet.choices.interval === null) return words.plan.noLines;
    const { text, count, length } = kind === 'geojson' ? await this.geoJson(sheet, signal) : await this.drawing(sheet, kind, signal);
    signal.throwIfAborted();
    if (count === 0) return words.plan.empty;
    download(new Blob([text], { type: TYPES[kind] }), `${this.fileName(sheet)}.${kind}`);
    return words.plan.saved(String(count), this.shop.scale.format(length));
  }

  private async drawing(sheet: PlanSheet, kind: 'svg' | 'dxf', signal: AbortSignal): Promise<{ text: string; count: number; length: number }> {
    const { isOriginal } = this;
    const { omits } = this.shop.bench.view;
    const lines = isOriginal ? await sheet.originalLines({ signal, omits, progress: this.progress }) : sheet.shownLines(true);
    const titles = this.titles(sheet, isOriginal);
    const paper = sheet.paper(titles, true);
    const text = kind === 'dxf' ? drawingDxf(lines, paper, this.shop.settings.modelUnit) : drawingSvg(lines, paper, titles[0], this.description(sheet, titles));
    return { text, count: lines.length, length: lines.reduce((sum: number, line: DrawnLine) => sum + lengthOfLine(line), 0) };
  }

  private description(sheet: PlanSheet, titles: readonly string[]): string {
    const [right, up] = sheet.frame;
    return `${titles.join('; ')}. Right is ${right.join(' ')}, up is ${up.join(' ')} of the input, whose unit is ${UNITS[this.shop.settings.modelUnit].sign}.`;
  }

  private async geoJson(sheet: PlanSheet, signal: AbortSignal): Promise<{ text: string; count: number; length: number }> {
    const { view } = this.shop.bench;
    const plan = new PlanSheet(this.shop, { ...sheet.choices, side: 'plan' });
    const contours = this.isOriginal ? await plan.originalContours({ signal, omits: view.omits, progress: this.progress }) : plan.shownContours();
    const coordinates = new Coordinates(view.manifest!);
    const lines = contours.flatMap((contour) => contour.lines);
    const text = contourGeoJson(contours, plan.frame, (point) => coordinates.toInput(point), (point) => coordinates.toGlobe(point));
    return { text, count: lines.length, length: lines.reduce((sum, line) => sum + lengthOf(line), 0) };
  }

  /// The longest index contours have labels.
  private labelsOf(interval: number): Mark[] {
    const { view } = this.shop.bench;
    const { min, max } = view.manifest!.source;
    const least = LEAST_LABELLED * Math.hypot(...max.map((value, axis) => value - min[axis]));
    const plan = new PlanSheet(this.shop, { ...this.form.choices, side: 'plan', interval: interval * INDEX_EVERY });
    try {
      const all = plan.shownContours().flatMap(({ height, lines }) => lines.map((line) => ({ height, points: line.points, length: lengthOf(line) })));
      const longest = all.filter(({ length }) => length >= least).sort((a, b) => b.length - a.length).slice(0, MOST_LABELS);
      return longest.map(({ height, points }) => ({ at: points[Math.floor(points.length / 2)], text: coordinateText(height, interval), isBare: true }));
    } catch {
      this.note.textContent = words.plan.tooMany;
      return [];
    }
  }
}

export function makeTool(shop: Workshop): Tool {
  return new PlanTool(shop);
}
