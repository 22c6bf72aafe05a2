// SPDX-License-Identifier: MIT
// A drawing as it was chosen: where it looks, what it cuts, and the paper that it fills.
import { heightAt } from '../../src/scene/projection.js';
import { contoursOf, type Contour, type Heights } from '../../src/tools/contours.js';
import { Coordinates } from '../../src/tools/coordinates.js';
import { drawnPlace, extentOf, frameOf, paperAxis, poseFor, rangeAlong, stretchedFrame, type DrawingSide } from '../../src/tools/drawing_side.js';
import { contourLines, sectionLines, type DrawingFrame, type DrawnLine } from '../../src/tools/line_drawing.js';
import { originalContours, originalSection } from '../../src/tools/original_lines.js';
import type { OriginalOptions } from '../../src/tools/original_triangles.js';
import { paperDrawer, sizeOfPaper } from '../../src/tools/paint_paper.js';
import { paperFor, type Extent, type Flat, type Paper, type PaperAxis } from '../../src/tools/paper.js';
import type { CutPlane } from '../../src/tools/planes.js';
import { takePicture, type PictureOptions, type PictureSize } from '../../src/tools/screenshot.js';
import { sectionOf, type Polyline } from '../../src/tools/section.js';
import { shownSurface } from '../../src/tools/shown_triangles.js';
import { UNITS } from '../../src/tools/units.js';
import { dot, scale, type Vector } from '../../src/tools/vectors.js';
import { VIEW_ANGLE } from '../view/camera_moves.js';
import type { Sight } from '../view/view_camera.js';
import { untilSettled } from './until_settled.js';
import type { Workshop } from './workshop.js';

export interface PlanChoices {
  readonly side: DrawingSide;
  /// What the page shows now; else the whole model.
  readonly isPart: boolean;
  /// Where the model is cut, by the input's axis that leads to the viewer; null: it is whole.
  readonly cutAt: number | null;
  /// N of 1:N.
  readonly scale: number;
  readonly dotsPerInch: number;
  readonly hasGrid: boolean;
  /// Null: no contours.
  readonly interval: number | null;
}

/// The titles of a drawing, as soon as it is known what was drawn.
export type TitlesOf = () => readonly string[];

const WHITE = [255, 255, 255];
/// Drawings are as fine as a view can be at rest: triangles are down to a pixel, or exact.
const FINEST = { restDetail: 16 };
const PAD = 3; // millimetres around the whole model

export class PlanSheet {
  /// In which lengths are true.
  readonly frame: DrawingFrame;
  private readonly coordinates: Coordinates;
  private readonly origin: Vector;

  constructor(private readonly shop: Workshop, readonly choices: PlanChoices) {
    const { view } = shop.bench;
    this.coordinates = new Coordinates(view.manifest!);
    this.origin = this.coordinates.toInput([0, 0, 0]);
    this.frame = frameOf(choices.side, view.surfaceMatrix);
  }

  /// The input's axis along which the drawing looks.
  get depthAxis(): PaperAxis {
    return paperAxis(this.frame[2]);
  }

  /// By that axis.
  get depthRange(): readonly [least: number, most: number] {
    const { sign } = this.depthAxis;
    return rangeAlong(this.shop.bench.view.manifest!.source, scale(this.frame[2], sign));
  }

  /// Null: the unit is not known.
  get metres(): number | null {
    return UNITS[this.shop.settings.modelUnit].metres;
  }

  /// In the tiles' coordinates; null: nothing is cut.
  get plane(): CutPlane | null {
    const { choices: { cutAt }, frame: [, , towards], origin } = this;
    if (cutAt === null) return null;
    return { normal: scale(towards, -1), constant: cutAt * this.depthAxis.sign - dot(towards, origin) };
  }

  /// In the tiles' coordinates.
  get heights(): Heights {
    const [, , up] = frameOf('plan', this.shop.bench.view.surfaceMatrix);
    return { up, shift: dot(up, this.origin) };
  }

  private get stretch(): number {
    return this.choices.side === 'plan' ? 1 : this.shop.bench.view.standing.stretch;
  }

  /// `isTrue`: heights are not stretched, as in files of lines.
  private frameFor(isTrue: boolean): DrawingFrame {
    return isTrue ? this.frame : stretchedFrame(this.choices.side, this.frame, this.stretch);
  }

  private wholeExtent(isTrue: boolean): Extent {
    const pad = (PAD * this.choices.scale) / (1000 * (this.metres ?? 1));
    const { left, right, bottom, top } = extentOf(this.shop.bench.view.manifest!.source, this.frameFor(isTrue));
    return { left: left - pad, right: right + pad, bottom: bottom - pad, top: top + pad };
  }

  private partExtent(isTrue: boolean): Extent {
    const { bench } = this.shop;
    const pose = bench.pose();
    const [x, y] = drawnPlace(this.choices.side, pose.target, this.frameFor(false), this.origin);
    const height = heightAt(pose.distance, VIEW_ANGLE);
    const width = (height * bench.surface.clientWidth) / bench.surface.clientHeight;
    const down = isTrue ? this.stretch : 1;
    return { left: x - width / 2, right: x + width / 2, bottom: (y - height / 2) / down, top: (y + height / 2) / down };
  }

  /// `isTrue`: heights are not stretched.
  paper(titles: readonly string[], isTrue: boolean): Paper {
    const { choices: { isPart, scale: scaled, hasGrid }, shop, metres } = this;
    const [right, up] = this.frameFor(isTrue);
    const axes = [paperAxis(right), paperAxis(up, isTrue ? 1 : this.stretch)] as const;
    const { sign } = UNITS[shop.settings.modelUnit];
    return paperFor(isPart ? this.partExtent(isTrue) : this.wholeExtent(isTrue), { scale: scaled, metres: metres ?? 1, sign, axes, hasGrid, titles });
  }

  size(titles: readonly string[]): PictureSize {
    return sizeOfPaper(this.paper(titles, false), this.choices.dotsPerInch);
  }

  private sightOf(paper: Paper, { width, height }: PictureSize): Sight {
    const pixels = (paper.mmPerUnit * this.choices.dotsPerInch) / 25.4;
    const { extent: { left, top } } = paper;
    const margin = paper.margin / paper.mmPerUnit;
    const middle: Flat = [left - margin + width / 2 / pixels, top + margin - height / 2 / pixels];
    return { pose: poseFor(this.choices.side, middle, height / pixels, this.frameFor(false), this.origin, VIEW_ANGLE), projection: 'parallel' };
  }

  /// Rejects when the signal aborts.
  async takePicture(titlesOf: TitlesOf, options: PictureOptions & { readonly signal: AbortSignal }): Promise<Blob> {
    const { shop: { bench }, choices: { dotsPerInch } } = this;
    const size = this.size(titlesOf());
    const stage = bench.freeze(size, this.sightOf(this.paper(titlesOf(), false), size));
    const { restDetail } = bench.view.settings;
    bench.view.setSettings(FINEST);
    try {
      await untilSettled(bench, options.signal);
      options.signal.throwIfAborted();
      const paper = this.paper(titlesOf(), false);
      return await takePicture(size, paperDrawer(stage.draw, paper, this.shownLines(false), dotsPerInch), WHITE, { ...options, dotsPerInch });
    } finally {
      bench.view.setSettings({ restDetail });
      stage.release();
    }
  }

  // ---- lines

  private lines(section: readonly Polyline[], contours: readonly Contour[], isTrue: boolean): DrawnLine[] {
    const { choices: { interval, cutAt } } = this;
    const frame = this.frameFor(isTrue);
    const toInput = (point: Vector): Vector => this.coordinates.toInput(point);
    const height = (cutAt ?? 0) * this.depthAxis.sign;
    return [...contourLines(contours, interval ?? 1, frame, toInput), ...sectionLines(section, frame, toInput, height)];
  }

  /// Only what the cut keeps is above it.
  private get contourInterval(): number | null {
    return this.choices.side === 'plan' ? this.choices.interval : null;
  }

  /// Throws RangeError where contours are too many.
  shownContours(): Contour[] {
    const { contourInterval } = this;
    return contourInterval === null ? [] : contoursOf(shownSurface(this.shop.bench.view), this.heights, contourInterval);
  }

  shownLines(isTrue: boolean): DrawnLine[] {
    const { plane } = this;
    const section = plane === null ? [] : sectionOf(shownSurface(this.shop.bench.view), plane);
    return this.lines(section, this.belowCut(this.shownContours()), isTrue);
  }

  /// The same of the original mesh.
  async originalLines(options: OriginalOptions): Promise<DrawnLine[]> {
    const { plane, shop: { bench: { view: { source } } } } = this;
    if (source === null) return [];
    const section = plane === null ? [] : await originalSection(source, plane, options);
    return this.lines(section, await this.originalContours(options), true);
  }

  async originalContours(options: OriginalOptions): Promise<Contour[]> {
    const { contourInterval, shop: { bench: { view: { source } } } } = this;
    if (contourInterval === null || source === null) return [];
    return this.belowCut(await originalContours(source, this.heights, contourInterval, options));
  }

  private belowCut(contours: Contour[]): Contour[] {
    const { cutAt } = this.choices;
    return cutAt === null ? contours : contours.filter(({ height }) => height <= cutAt * this.depthAxis.sign);
  }
}
