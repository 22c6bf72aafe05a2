// SPDX-License-Identifier: MIT
// The things that a model consists of: picked by a tap, marked, flown to, left out.
import { Color, EventDispatcher, NoColorSpace, type Vector3 } from 'three';
import type { ObjectRow } from '../hierarchy/object_blocks.js';
import type { ObjectRange, ObjectTable } from '../hierarchy/object_table.js';
import type { HierarchyView, Plugin, Stage } from '../scene/hierarchy_view.js';
import type { RampName } from '../scene/ramps.js';
import { Coordinates } from '../tools/coordinates.js';
import { colourObjects, type ObjectLegend } from '../tools/object_colours.js';
import { cornersInWorld, poseOfObject } from '../tools/object_pose.js';
import type { PickedPoint } from '../tools/picked_point.js';
import { Pointing } from '../tools/pointing.js';
import { ObjectOutline } from './object_outline.js';
import { MARK, ObjectShading } from './object_shading.js';
import type { Frame } from './plugin.js';

export interface ObjectsOptions {
  /// False: objects are not picked by tapping; `pick` is yours to call.
  isAlone?: boolean;
  /// Another one than `objects`.
  name?: string;
}

/// Objects that are left out, or shown alone: each text is a name, or where it ends with "/" the beginning of names.
export interface ObjectChoice {
  readonly hidden: readonly string[];
  readonly only: readonly string[];
}

/// All of a table is read for colours: about 6 MB.
const MOST_COLOURED = 2 ** 17;

const ALL: ObjectChoice = { hidden: [], only: [] };

/// Event `change`: another object is picked, or others are drawn. `problem`: what was asked for could not be read.
export class Objects extends EventDispatcher<{ change: object; problem: { message: string } }> implements Plugin {
  readonly name: string;
  readonly shading = new ObjectShading();
  private view: HierarchyView | null = null;
  private stage: Stage | null = null;
  private pointing: Pointing | null = null;
  private row: ObjectRow | null = null;
  private chosen = ALL;
  private table: ObjectTable | null = null;
  private outline: ObjectOutline | null = null;
  private asking = new AbortController();
  private asked = 0; // choices of what is drawn
  private coloursAsked = 0;
  private coloured: ObjectLegend | null = null;

  constructor(private readonly options: ObjectsOptions = {}) {
    super();
    this.name = options.name ?? 'objects';
  }

  init(view: HierarchyView): void {
    this.view = view;
  }

  enter(stage: Stage): void {
    this.stage = stage;
    this.pointing = new Pointing(stage);
  }

  /// Null: nothing is picked.
  get picked(): ObjectRow | null {
    return this.row;
  }

  get choice(): ObjectChoice {
    return this.chosen;
  }

  tapped(right: number, up: number): boolean {
    if (this.options.isAlone === false || this.view?.objects == null) return false;
    void this.pick(right, up);
    return true;
  }

  /// Picks what is at a place of the picture: at once as it is shown, then as it is in the original. Resolves with null where nothing is.
  async pick(right: number, up: number): Promise<ObjectRow | null> {
    this.asking.abort();
    this.asking = new AbortController();
    const { signal } = this.asking;
    const pointed = this.pointing?.at(right, up, false, signal) ?? null;
    if (pointed === null) return this.choose(null);
    const shown = this.objectAt(pointed.shown);
    const row = await this.chooseNumber(shown, signal);
    const original = await pointed.original.catch(() => null);
    const object = original === null ? shown : this.objectAt(original);
    return object === shown ? row : this.chooseNumber(object, signal);
  }

  /// Null: none.
  choose(row: ObjectRow | null): ObjectRow | null {
    this.row = row;
    this.shading.mark(row?.object ?? null);
    this.changed();
    return row;
  }

  /// Picks the object of that name. Resolves with null where there is none.
  async chooseNamed(name: string): Promise<ObjectRow | null> {
    this.asking.abort();
    this.asking = new AbortController();
    const { signal } = this.asking;
    const row = await this.read((table) => table.find(name));
    return signal.aborted ? null : this.choose(row);
  }

  /// Flies to where the picked object is seen whole. Nothing happens where it has no triangles.
  go(): void {
    const { view, stage, row } = this;
    if (view?.manifest == null || stage === null || row?.box == null) return;
    stage.fly(poseOfObject(cornersInWorld(row.box, new Coordinates(view.manifest), view.surfaceMatrix), stage.pose(), stage.camera));
  }

  /// Shows others than before, once their numbers are read. Names that no object has do nothing.
  async draw(choice: Partial<ObjectChoice>): Promise<void> {
    this.chosen = { ...this.chosen, ...choice };
    const asked = ++this.asked;
    const { hidden, only } = this.chosen;
    const [out, shown] = [await this.rangesOf(hidden), await this.rangesOf(only)];
    if (asked !== this.asked || this.view === null) return;
    const count = this.view.objects?.count ?? 0;
    if (only.length > 0) this.shading.leaveOut(without(shown, out), true, count);
    else this.shading.leaveOut(out.length > 0 ? out : null, false, count);
    this.changed();
  }

  /// Colours objects by a property: numbers along a ramp, other values each by its own. Null: they look as they are. Nothing happens where there is
  /// no such property; a table of more than 2^17 objects is refused, as a problem.
  async colourBy(name: string | null, ramp: RampName = 'viridis'): Promise<void> {
    const asked = ++this.coloursAsked;
    const coloured = name === null ? null : await this.read(async (table) => {
      const at = table.properties.findIndex((each) => each.name === name);
      if (at < 0) return null;
      if (table.count > MOST_COLOURED) throw new Error(`${table.count} objects are too many to be coloured; ${MOST_COLOURED} can be`);
      return colourObjects(await table.rows({ begin: 0, end: table.count }), table.properties[at], at, ramp);
    });
    if (asked !== this.coloursAsked || this.view === null) return;
    this.coloured = coloured?.legend ?? null;
    this.shading.colour(coloured?.bytes ?? null);
    this.changed();
  }

  /// What the colours mean; null: objects look as they are.
  get legend(): ObjectLegend | null {
    return this.coloured;
  }

  /// The model may have become another one.
  drawn(): void {
    const table = this.view?.objects ?? null;
    if (table === this.table) return;
    const { table: before } = this;
    this.table = table;
    if (before === null) return;
    if (this.row !== null) void this.chooseNamed(this.row.name);
    if (this.chosen !== ALL) void this.draw({});
    if (this.coloured !== null) void this.colourBy(this.coloured.property.name);
  }

  /// A line around the picked object; in pictures that a plug-in has painted it has its colour alone.
  shade(frame: Frame): void {
    if (!this.shading.isMarking || frame.renderer.xr.isPresenting) return;
    this.outline ??= new ObjectOutline(this.shading.uniforms.markedObject, new Color().setHex(MARK, NoColorSpace));
    this.outline.draw(frame);
  }

  keeps(_: Vector3, values: readonly number[]): boolean {
    const object = this.shading.objectOf(values);
    return object === null || this.shading.draws(object);
  }

  dispose(): void {
    this.asking.abort();
    ++this.asked;
    ++this.coloursAsked;
    this.coloured = null;
    this.shading.dispose();
    this.outline?.dispose();
    this.outline = null;
    [this.view, this.stage, this.pointing, this.table, this.row, this.chosen] = [null, null, null, null, null, ALL];
  }

  private objectAt({ values }: PickedPoint): number | null {
    return this.shading.objectOf(values.map(({ value }) => value ?? -1));
  }

  private async chooseNumber(object: number | null, signal: AbortSignal): Promise<ObjectRow | null> {
    const count = this.view?.objects?.count ?? 0;
    const row = object === null || object >= count ? null : await this.read((table) => table.row(object));
    return signal.aborted ? null : this.choose(row);
  }

  private async rangesOf(names: readonly string[]): Promise<ObjectRange[]> {
    const ranges = await Promise.all(names.map((name) => this.read(async (table) => {
      if (name.endsWith('/')) return table.range(name);
      const row = await table.find(name);
      return row && { begin: row.object, end: row.object + 1 };
    })));
    return ranges.filter((range) => range !== null);
  }

  /// Null: there is no table, or it could not be read, which is told.
  private async read<T>(ask: (table: ObjectTable) => Promise<T>): Promise<T | null> {
    const table = this.view?.objects ?? null;
    try {
      return table && (await ask(table));
    } catch (problem) {
      this.dispatchEvent({ type: 'problem', message: problem instanceof Error ? problem.message : String(problem) });
      return null;
    }
  }

  private changed(): void {
    this.view?.setLook({}); // tiles are shown anew
    this.dispatchEvent({ type: 'change' });
  }
}

/// What is in `ranges` and in none of `others`.
function without(ranges: readonly ObjectRange[], others: readonly ObjectRange[]): ObjectRange[] {
  return others.reduce<ObjectRange[]>(
    (left, { begin, end }) => left.flatMap((range) => [{ begin: range.begin, end: Math.min(range.end, begin) }, { begin: Math.max(range.begin, end), end: range.end }].filter((part) => part.begin < part.end)),
    [...ranges],
  );
}
