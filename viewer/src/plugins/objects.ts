// SPDX-License-Identifier: MIT
// The things that a model consists of: picked by a tap, marked, flown to, left out.
import { Color, EventDispatcher, NoColorSpace, type Vector3 } from 'three';
import type { ObjectBox, ObjectRow } from '../hierarchy/object_blocks.js';
import type { ObjectRange, ObjectTable } from '../hierarchy/object_table.js';
import { boxOfRange } from '../hierarchy/object_tree.js';
import type { HierarchyView, Plugin, Stage } from '../scene/hierarchy_view.js';
import type { RampName } from '../scene/ramps.js';
import { Coordinates } from '../tools/coordinates.js';
import { ALL_OBJECTS, type ObjectChoice } from '../tools/object_choice.js';
import { ObjectColours, type ObjectLegend } from '../tools/object_colours.js';
import { cornersInWorld, poseOfObject } from '../tools/object_pose.js';
import type { PickedPoint } from '../tools/picked_point.js';
import { Pointing } from '../tools/pointing.js';
import type { ObjectLayer } from './left_out_objects.js';
import { ObjectOutline } from './object_outline.js';
import { MARK, ObjectShading } from './object_shading.js';
import { texelBytes } from './object_texels.js';
import type { Frame } from './plugin.js';

export interface ObjectsOptions {
  /// False: objects are not picked by tapping; `pick` is yours to call.
  isAlone?: boolean;
  /// Another one than `objects`.
  name?: string;
}

/// All of a table is read for colours: about 25 bytes an object.
const MOST_COLOURED = 2 ** 22;
const TOLD_AGAIN = 500; // milliseconds

/// Event `change`: another object is picked, or others are drawn. `problem`: what was asked for could not be read. `reading`: of so many of all
/// objects the property is read that they get colours by; not if that is soon done.
export class Objects extends EventDispatcher<{ change: object; problem: { message: string }; reading: { done: number; all: number } }> implements Plugin {
  readonly name: string;
  readonly shading = new ObjectShading();
  private view: HierarchyView | null = null;
  private stage: Stage | null = null;
  private pointing: Pointing | null = null;
  private row: ObjectRow | null = null;
  private chosen = ALL_OBJECTS;
  private table: ObjectTable | null = null;
  private outline: ObjectOutline | null = null;
  private asking = new AbortController();
  private asked = 0; // choices of what is drawn
  private coloursAsked = 0;
  private coloured: ObjectLegend | null = null;
  private colours: ObjectColours | null = null;
  private colourBytes: Uint8Array<ArrayBuffer> | null = null;

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

  /// Picks the object of that number. Resolves with null where there is none.
  async chooseObject(object: number): Promise<ObjectRow | null> {
    this.asking.abort();
    this.asking = new AbortController();
    return this.chooseNumber(object, this.asking.signal);
  }

  /// Flies to where the picked object is seen whole. Nothing happens where it has no triangles.
  go(): void {
    this.flyTo(this.row?.box ?? null);
  }

  /// Flies to where objects are seen whole that follow each other, as those of a branch do.
  async goTo(range: ObjectRange): Promise<void> {
    this.flyTo(await this.read((table) => boxOfRange(table, range)));
  }

  /// Shows others than before, once their numbers are read. Names that no object has do nothing; what begins as a shorter text does comes after it.
  async draw(choice: Partial<ObjectChoice>): Promise<void> {
    this.chosen = { ...this.chosen, ...choice };
    const asked = ++this.asked;
    const { hidden, only, shown } = this.chosen;
    const texts = [...hidden.map((text) => ({ text, isOut: true })), ...shown.map((text) => ({ text, isOut: false }))].sort((a, b) => a.text.length - b.text.length);
    const layers = await this.layersOf([...only.map((text) => ({ text, isOut: false })), ...texts]);
    if (asked !== this.asked || this.view === null) return;
    const count = this.view.objects?.count ?? 0;
    this.shading.leaveOut(only.length > 0 ? [{ begin: 0, end: count, isOut: true }, ...layers] : layers, count);
    this.changed();
  }

  /// Colours objects by a property: numbers along a ramp, from `range[0]` to `range[1]` if given, other values each by its own. They come as the
  /// table is read. Null: objects look as they are. Nothing happens where there is no such property; a table of more than 2^22 objects is
  /// refused, as a problem.
  async colourBy(name: string | null, ramp: RampName = 'viridis', range: readonly [number, number] | null = null): Promise<void> {
    const asked = ++this.coloursAsked;
    const isWanted = (): boolean => asked === this.coloursAsked;
    const colours = name === null ? null : await this.read((table) => this.coloursOf(table, name, { ramp, range }, isWanted));
    if (isWanted()) this.showColours(colours);
  }

  /// The ramp goes from one number to the other from now on. Null: over all numbers.
  colourRange(range: readonly [number, number] | null): void {
    if (this.colours === null) return;
    this.colours.range = range;
    this.showColours(this.colours);
  }

  /// Shows them as they come. Null: there is no such property.
  private async coloursOf(table: ObjectTable, name: string, { ramp, range }: { ramp: RampName; range: readonly [number, number] | null }, isWanted: () => boolean): Promise<ObjectColours | null> {
    const at = table.properties.findIndex((each) => each.name === name);
    if (at < 0) return null;
    if (table.count > MOST_COLOURED) throw new Error(`${table.count} objects are too many to be coloured; ${MOST_COLOURED} can be`);
    const colours = new ObjectColours(table.properties[at], table.count, ramp);
    colours.range = range;
    let told = performance.now();
    for await (const part of table.column(at)) {
      if (!isWanted()) break;
      colours.add(part);
      if (performance.now() - told < TOLD_AGAIN) continue;
      this.showColours(colours);
      this.dispatchEvent({ type: 'reading', done: part.first, all: table.count });
      await new Promise((resolve) => setTimeout(resolve)); // frames come between
      told = performance.now();
    }
    return colours;
  }

  private showColours(colours: ObjectColours | null): void {
    if (colours === null && this.colours === null) return;
    this.colours = colours;
    this.coloured = colours?.legend() ?? null;
    this.colourBytes = colours && (this.colourBytes ?? texelBytes(this.view?.objects?.count ?? 0, 4));
    if (this.colourBytes !== null) colours?.paint(this.colourBytes);
    this.shading.colour(this.colourBytes);
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
    if (this.chosen !== ALL_OBJECTS) void this.draw({});
    this.colourBytes = null;
    if (this.coloured !== null) void this.colourBy(this.coloured.property.name, this.colours?.ramp, this.colours?.range);
  }

  /// A line around the picked object, as far as it is not cut away.
  mark(frame: Frame): void {
    const { view } = this;
    if (view === null || !this.shading.isMarking || frame.renderer.xr.isPresenting) return;
    this.outline ??= new ObjectOutline(this.shading.uniforms.markedObject, new Color().setHex(MARK, NoColorSpace));
    this.outline.draw(frame, view);
  }

  keeps(_: Vector3, values: readonly number[]): boolean {
    const object = this.shading.objectOf(values);
    return object === null || this.shading.draws(object);
  }

  dispose(): void {
    this.asking.abort();
    ++this.asked;
    ++this.coloursAsked;
    this.coloured = this.colours = this.colourBytes = null;
    this.shading.dispose();
    this.outline?.dispose();
    this.outline = null;
    [this.view, this.stage, this.pointing, this.table, this.row, this.chosen] = [null, null, null, null, null, ALL_OBJECTS];
  }

  private objectAt({ values }: PickedPoint): number | null {
    return this.shading.objectOf(values.map(({ value }) => value ?? -1));
  }

  private async chooseNumber(object: number | null, signal: AbortSignal): Promise<ObjectRow | null> {
    const count = this.view?.objects?.count ?? 0;
    const row = object === null || object >= count ? null : await this.read((table) => table.row(object));
    return signal.aborted ? null : this.choose(row);
  }

  private flyTo(box: ObjectBox | null): void {
    const { view, stage } = this;
    if (view?.manifest == null || stage === null || box === null) return;
    stage.fly(poseOfObject(cornersInWorld(box, new Coordinates(view.manifest), view.surfaceMatrix), stage.pose(), stage.camera));
  }

  private layersOf(texts: readonly { readonly text: string; readonly isOut: boolean }[]): Promise<ObjectLayer[]> {
    return Promise.all(texts.map(async ({ text, isOut }) => ({ ...(await this.rangeOf(text)), isOut })));
  }

  private async rangeOf(text: string): Promise<ObjectRange> {
    const range = await this.read(async (table) => {
      if (text.endsWith('/')) return table.range(text);
      const row = await table.find(text);
      return row && { begin: row.object, end: row.object + 1 };
    });
    return range ?? { begin: 0, end: 0 };
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
