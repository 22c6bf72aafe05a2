// SPDX-License-Identifier: MIT
// Cuts the model open by a plane or a box, and draws the section.
import { Clipping } from '../../src/plugins/clipping.js';
import { Coordinates } from '../../src/tools/coordinates.js';
import { boxPlanes, cutPlane, flipped, localNormal, planesInTiles, type CutPlane } from '../../src/tools/planes.js';
import { lengthOf, sectionOf } from '../../src/tools/section.js';
import { drawingAxes, sectionSvg } from '../../src/tools/section_svg.js';
import { shownSurface } from '../../src/tools/shown_triangles.js';
import { UNITS, type LengthScale } from '../../src/tools/units.js';
import { dot, type Vector } from '../../src/tools/vectors.js';
import { readLink, writeLink } from '../../src/view/view_link.js';
import type { View } from '../../src/view/view_table.js';
import { checkbox, choice, slider, type ChoiceControl, type Control } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { CutVolume, type Kept } from './cut_volume.js';
import { download } from './download.js';
import { textButton } from './figures.js';
import type { Tool } from './tool.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

const AXES = ['x', 'y', 'z'] as const;
const STEPS = 500; // of a slider
/// The cosine between a plane's normal and up from which a terrain lies above it or below.
const LEVEL = 0.7;
const UNIT_AXES: readonly Vector[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

type CutMode = keyof typeof words.clip.modes;
type Direction = keyof typeof words.clip.directions;

interface BoxCorners {
  readonly min: Vector;
  readonly max: Vector;
}

/// Returns the range of the model along a direction.
function rangeAlong({ min, max }: BoxCorners, normal: Vector): readonly [number, number] {
  const ends = normal.map((part, axis) => [part * min[axis], part * max[axis]]);
  return [ends.reduce((sum, pair) => sum + Math.min(...pair), 0), ends.reduce((sum, pair) => sum + Math.max(...pair), 0)];
}

function rangeOf([least, most]: readonly [number, number]): { least: number; most: number; step: number } {
  return { least, most, step: (most - least) / STEPS };
}

export class ClipTool implements Tool {
  readonly root: HTMLElement;
  private readonly coordinates: Coordinates;
  private readonly clipping = new Clipping('page clipping');
  private readonly extent: BoxCorners;
  private readonly planeForm = element('div', { class: 'tool-form tool-plane' });
  private readonly boxForm: HTMLElement;
  private readonly volume: CutVolume;
  private readonly caps: Control<boolean>;
  private readonly modes: Control<CutMode>;
  private position = element('div', {});
  private readonly directions: ChoiceControl<Direction>;
  private readonly sliders = { min: [] as Control<number>[], max: [] as Control<number>[] };
  private isFollowing = true; // a link, which stays as it is meanwhile
  private mode: CutMode = 'off';
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
    this.volume = new CutVolume(shop, () => this.kept());
    view.registerPlugin(this.clipping);
    this.extent = { min, max };
    this.sides = { min: [...min], max: [...max] };
    const { clip } = words;
    this.modes = choice(clip.mode, Object.entries(clip.modes) as [CutMode, string][], (mode) => { this.setMode(mode); });
    this.caps = checkbox(clip.caps, null, (on) => { this.isCapped = on; this.apply(); });
    this.caps.show(view.closed);
    this.caps.root.hidden = !view.closed;
    this.caps.root.classList.add('tool-extra');
    this.directions = choice(clip.direction, Object.entries(clip.directions) as [Direction, string][], (direction) => { this.turn(direction); });
    this.makePlaneForm();
    this.boxForm = this.makeBoxForm();
    const open = view.closed ? null : element('p', { class: 'tool-note tool-extra' }, clip.noCaps);
    this.root = element('div', {}, this.modes.root, this.planeForm, this.boxForm, this.caps.root, ...this.volume.parts, open, this.volume.note);
    shop.link('cut').onFollow(() => { this.follow(); });
    if (shop.link('cut').text !== '') this.follow();
    else this.begin();
  }

  private begin(): void {
    this.isFollowing = false;
    this.setMode('plane');
  }

  /// As a link says.
  private follow(): void {
    const { cut, box, caps = true } = readLink(this.shop.link('cut').text);
    this.isFollowing = true;
    this.isCapped = caps;
    this.caps.show(caps && this.shop.bench.view.closed);
    if (cut !== undefined) this.takePlane(cut);
    if (box !== undefined) this.takeBox(box);
    this.setMode(cut !== undefined ? 'plane' : box !== undefined ? 'box' : 'off');
    this.isFollowing = false;
  }

  private takePlane(cut: NonNullable<View['cut']>): void {
    const { normal, constant } = cutPlane(cut);
    const axis = normal.findIndex((part) => Math.abs(part) === 1);
    this.directions.show(axis >= 0 ? AXES[axis] : 'view');
    this.normal = axis >= 0 ? UNIT_AXES[axis] : normal;
    this.isFlipped = axis >= 0 && normal[axis] < 0;
    this.offset = this.isFlipped ? constant : -constant;
    this.showPosition();
  }

  private takeBox([a, b, c, d, e, f]: NonNullable<View['box']>): void {
    Object.assign(this.sides, { min: [a, b, c], max: [d, e, f] });
    for (const end of ['min', 'max'] as const) this.sliders[end].forEach((made, axis) => { made.show(this.sides[end][axis]); });
  }

  /// What links tell of it.
  private get link(): string {
    const { min, max } = this.sides;
    if (this.mode === 'off') return '';
    const caps = this.shop.bench.view.closed ? this.isCapped : undefined;
    if (this.mode === 'box') return writeLink({ box: [...min, ...max], caps });
    const [{ normal, constant }] = this.planes();
    return writeLink({ cut: [...normal, constant], caps });
  }

  /// Returns the sign of the model's unit; '': it is not known.
  private get sign(): string {
    const { modelUnit } = this.shop.settings;
    return modelUnit === 'unit' ? '' : UNITS[modelUnit].sign;
  }

  private makePlaneForm(): void {
    const { clip } = words;
    this.directions.show('x');
    const flip = textButton(clip.flip, () => { this.isFlipped = !this.isFlipped; this.apply(); });
    const save = textButton(clip.export, () => { this.export(); });
    save.classList.add('tool-extra');
    this.planeForm.append(this.directions.root, this.position, flip, save);
    this.turn('x');
  }

  private makeBoxForm(): HTMLElement {
    const sliders = AXES.flatMap((name, axis) => (['min', 'max'] as const).map((end) => {
      const { from, to } = words.clip.sides(name);
      const made = slider(end === 'min' ? from : to, this.sign, rangeOf([this.extent.min[axis], this.extent.max[axis]]), (value) => {
        this.sides[end][axis] = value;
        this.apply();
      });
      made.show(this.extent[end][axis]);
      this.sliders[end][axis] = made;
      return made.root;
    }));
    return element('div', { class: 'tool-form' }, ...sliders);
  }

  private setMode(mode: CutMode): void {
    this.mode = mode;
    this.modes.show(mode);
    this.planeForm.hidden = mode !== 'plane';
    this.boxForm.hidden = mode !== 'box';
    this.apply();
  }

  /// Through the middle of the model; what the camera looks at is cut away.
  private turn(direction: Direction): void {
    const axis = AXES.findIndex((name) => name === direction);
    this.normal = axis >= 0 ? UNIT_AXES[axis] : this.viewDirection();
    const ends = rangeAlong(this.extent, this.normal);
    this.offset = (ends[0] + ends[1]) / 2;
    this.isFlipped = dot(this.normal, this.viewDirection()) < 0;
    this.showPosition();
    this.apply();
  }

  private showPosition(): void {
    const made = slider(words.clip.position, this.sign, rangeOf(rangeAlong(this.extent, this.normal)), (value) => { this.offset = value; this.apply(); });
    made.show(this.offset);
    this.position.replaceWith(made.root);
    this.position = made.root as HTMLDivElement;
  }

  private viewDirection(): Vector {
    const { bench } = this.shop;
    return localNormal(bench.pose().forward.toArray(), bench.view.surfaceMatrix);
  }

  /// Returns the planes in the input's coordinates.
  private planes(): CutPlane[] {
    if (this.mode === 'off') return [];
    if (this.mode === 'box') return boxPlanes(this.sides.min, this.sides.max);
    const plane = { normal: this.normal, constant: -this.offset };
    return [this.isFlipped ? flipped(plane) : plane];
  }

  /// Returns the planes in the tiles' coordinates.
  private localPlanes(): CutPlane[] {
    return planesInTiles(this.planes(), this.coordinates);
  }

  private apply(): void {
    const { bench } = this.shop;
    this.clipping.cut(this.localPlanes(), this.isCapped);
    this.volume.stop();
    if (!this.isFollowing) this.shop.link('cut').write(this.link);
    bench.redraw();
  }

  private export(): void {
    const { bench, settings } = this.shop;
    const { view } = bench;
    const lines = sectionOf(shownSurface(view), this.localPlanes()[0])
      .map(({ points, isClosed }) => ({ points: points.map((point) => this.coordinates.toInput(point)), isClosed }));
    if (lines.length === 0) {
      this.volume.note.textContent = words.clip.nothing;
      return;
    }
    const length = lines.reduce((sum, each) => sum + lengthOf(each), 0);
    const toldIn = (scale: LengthScale): string => words.clip.section(bench.name, String(lines.length), scale.format(length));
    const levels = view.surface.map(({ node }) => node.level);
    const from = words.clip.levels(String(Math.min(...levels)), String(Math.max(...levels)), String(view.source!.tree.lastLevel));
    const axes = drawingAxes(this.normal, view.upwards);
    download(new Blob([sectionSvg(lines, { axes, unit: settings.modelUnit, title: `${toldIn(this.shop.scale.plain)}; ${from}` })], { type: 'image/svg+xml' }), `${bench.name}-section.svg`);
    this.volume.note.textContent = toldIn(this.shop.scale);
  }

  drawn(): void {
    this.volume.drawn();
  }

  private kept(): Kept {
    const { view } = this.shop.bench;
    const below = this.coordinates.toInput([0, 0, 0])[2] - this.extent.min[2];
    const planes = this.localPlanes();
    return {
      planes: planes.length === 0 ? [{ normal: UNIT_AXES[2], constant: below }] : planes,
      isLevel: this.mode === 'plane' && view.terrain !== null && Math.abs(dot(this.normal, view.upwards)) > LEVEL,
    };
  }

  lasting(): string | null {
    return this.mode === 'off' ? null : words.clip.lasting;
  }

  end(): void {
    this.setMode('off');
  }

  close(): void {
    this.volume.stop();
    this.shop.bench.view.unregisterPlugin(this.clipping);
  }
}

export function makeTool(shop: Workshop): Tool {
  return new ClipTool(shop);
}
