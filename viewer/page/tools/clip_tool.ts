// SPDX-License-Identifier: MIT
// Cuts the model open by a plane or a box, and draws the section.
import { Coordinates } from '../../src/tools/coordinates.js';
import { boxPlanes, flipped, isKept, localNormal, type CutPlane } from '../../src/tools/planes.js';
import { lengthOf, sectionOf } from '../../src/tools/section.js';
import { drawingAxes, sectionSvg } from '../../src/tools/section_svg.js';
import { dot, type Vector } from '../../src/tools/vectors.js';
import { checkbox, choice, slider, type Control } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { CutPainter } from './cut_painter.js';
import { download } from './download.js';
import { textButton } from './figures.js';
import type { Tool } from './tool.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

const AXES = ['x', 'y', 'z'] as const;
const STEPS = 500; // of a slider
const UNIT_AXES: readonly Vector[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

type Mode = keyof typeof words.clip.modes;
type Direction = keyof typeof words.clip.directions;

interface Extent {
  readonly min: Vector;
  readonly max: Vector;
}

/// Of the model along a direction.
function rangeAlong({ min, max }: Extent, normal: Vector): readonly [number, number] {
  const ends = normal.map((part, axis) => [part * min[axis], part * max[axis]]);
  return [ends.reduce((sum, pair) => sum + Math.min(...pair), 0), ends.reduce((sum, pair) => sum + Math.max(...pair), 0)];
}

function rangeOf([least, most]: readonly [number, number]): { least: number; most: number; step: number } {
  return { least, most, step: (most - least) / STEPS };
}

export class ClipTool implements Tool {
  readonly root: HTMLElement;
  private readonly coordinates: Coordinates;
  private readonly painter: CutPainter;
  private readonly extent: Extent;
  private readonly planeForm = element('div', { class: 'tool-form tool-plane' });
  private readonly boxForm: HTMLElement;
  private readonly note = element('p', { class: 'tool-note', 'aria-live': 'polite' });
  private readonly caps: Control<boolean>;
  private readonly modes: Control<Mode>;
  private position = element('div', {});
  private mode: Mode = 'off';
  private normal: Vector = UNIT_AXES[0];
  private offset = 0;
  private isFlipped = false;
  private isCapped = true;
  private readonly sides: { min: [number, number, number]; max: [number, number, number] };

  /// In the input's coordinates, all of it.
  constructor(private readonly shop: Workshop) {
    const { view } = shop.bench;
    const { source: { min, max } } = view.manifest!;
    this.coordinates = new Coordinates(view.manifest!);
    this.painter = new CutPainter(view);
    this.extent = { min, max };
    this.sides = { min: [...min], max: [...max] };
    const { clip } = words;
    this.modes = choice(clip.mode, Object.entries(clip.modes) as [Mode, string][], (mode) => { this.setMode(mode); });
    this.caps = checkbox(clip.caps, null, (on) => { this.isCapped = on; this.apply(); });
    this.caps.show(view.closed);
    this.caps.root.hidden = !view.closed;
    this.caps.root.classList.add('tool-extra');
    this.makePlaneForm();
    this.boxForm = this.makeBoxForm();
    const open = view.closed ? null : element('p', { class: 'tool-note tool-extra' }, clip.noCaps);
    this.root = element('div', {}, this.modes.root, this.planeForm, this.boxForm, this.caps.root, open, this.note);
    this.setMode('plane');
  }

  private makePlaneForm(): void {
    const { clip } = words;
    const directions = choice(clip.direction, Object.entries(clip.directions) as [Direction, string][], (direction) => { this.turn(direction); });
    directions.show('x');
    const flip = textButton(clip.flip, () => { this.isFlipped = !this.isFlipped; this.apply(); });
    const save = textButton(clip.export, () => { this.export(); });
    save.classList.add('tool-extra');
    this.planeForm.append(directions.root, this.position, flip, save);
    this.turn('x');
  }

  private makeBoxForm(): HTMLElement {
    const sliders = AXES.flatMap((name, axis) => (['min', 'max'] as const).map((end) => {
      const { from, to } = words.clip.sides(name);
      const made = slider(end === 'min' ? from : to, '', rangeOf([this.extent.min[axis], this.extent.max[axis]]), (value) => {
        this.sides[end][axis] = value;
        this.apply();
      });
      made.show(this.extent[end][axis]);
      return made.root;
    }));
    return element('div', { class: 'tool-form' }, ...sliders);
  }

  private setMode(mode: Mode): void {
    this.mode = mode;
    this.modes.show(mode);
    this.planeForm.hidden = mode !== 'plane';
    this.boxForm.hidden = mode !== 'box';
    this.shop.bench.view.showsInside = mode !== 'off';
    this.apply();
  }

  /// Through the middle of the model; what the camera looks at is cut away.
  private turn(direction: Direction): void {
    const axis = AXES.findIndex((name) => name === direction);
    this.normal = axis >= 0 ? UNIT_AXES[axis] : this.viewDirection();
    const ends = rangeAlong(this.extent, this.normal);
    this.offset = (ends[0] + ends[1]) / 2;
    this.isFlipped = dot(this.normal, this.viewDirection()) < 0;
    const made = slider(words.clip.position, '', rangeOf(ends), (value) => { this.offset = value; this.apply(); });
    made.show(this.offset);
    this.position.replaceWith(made.root);
    this.position = made.root as HTMLDivElement;
    this.apply();
  }

  private viewDirection(): Vector {
    const { bench } = this.shop;
    return localNormal(bench.pose().forward.toArray(), bench.view.surfaceMatrix);
  }

  /// In the input's coordinates.
  private planes(): CutPlane[] {
    if (this.mode === 'off') return [];
    if (this.mode === 'box') return boxPlanes(this.sides.min, this.sides.max);
    const plane = { normal: this.normal, constant: -this.offset };
    return [this.isFlipped ? flipped(plane) : plane];
  }

  /// In the tiles' coordinates.
  private localPlanes(): CutPlane[] {
    const shift = this.coordinates.toInput([0, 0, 0]);
    return this.planes().map(({ normal, constant }) => ({ normal, constant: constant + dot(normal, shift) }));
  }

  private apply(): void {
    const { bench, pointing } = this.shop;
    const planes = this.localPlanes();
    pointing.keeps = (point) => isKept(planes, point);
    this.painter.set(planes, this.isCapped && bench.view.closed);
    bench.setPainter(planes.length > 0 ? this.painter : null);
    this.note.textContent = '';
    bench.redraw();
  }

  private export(): void {
    const { bench, settings } = this.shop;
    const { view } = bench;
    const lines = sectionOf(view.surface, this.localPlanes()[0])
      .map(({ points, isClosed }) => ({ points: points.map((point) => this.coordinates.toInput(point)), isClosed }));
    if (lines.length === 0) {
      this.note.textContent = words.clip.nothing;
      return;
    }
    const length = this.shop.scale().format(lines.reduce((sum, line) => sum + lengthOf(line), 0));
    const told = words.clip.section(bench.name, String(lines.length), length);
    const levels = view.surface.map(({ node }) => node.level);
    const from = words.clip.levels(String(Math.min(...levels)), String(Math.max(...levels)), String(view.source!.tree.lastLevel));
    const axes = drawingAxes(this.normal, view.upwards);
    download(new Blob([sectionSvg(lines, { axes, unit: settings.modelUnit, title: `${told}; ${from}` })], { type: 'image/svg+xml' }), `${bench.name}-section.svg`);
    this.note.textContent = told;
  }

  lasting(): string | null {
    return this.mode === 'off' ? null : words.clip.lasting;
  }

  end(): void {
    this.setMode('off');
  }

  close(): void {
    this.painter.dispose();
  }
}

export function makeTool(shop: Workshop): Tool {
  return new ClipTool(shop);
}
