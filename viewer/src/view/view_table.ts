// SPDX-License-Identifier: MIT
// What a view is: how a model is looked at. Links, manifests, stories, the code for other pages and what the browser keeps are all written and
// read by this table; the program has the same one (docs/config.md, `view`), and tests/data/views.json holds both to it.
//
//   #MODEL & px,py,pz,tx,ty,tz & colours=attribute & range=-1,1 & cut=0,0,1,-2 …      a link: defaults are left out, in the table's order
//   { "camera": [px, …], "colours": "attribute", "range": [-1, 1], "cut": [0, 0, 1, -2], … }   the same as JSON
//
// Keys of one part are said together: whoever says one of them says all, and the others are then as without a choice.
import { areNear } from '../farthest.js';
import { WAYS } from '../pair/ways.js';
import { RAMPS } from '../scene/ramp_names.js';
import type { Projection } from '../scene/projection.js';
import { DEFAULT_LOOK, type Colours } from '../scene/settings.js';
import { DEFAULT_STANDING, MOST_STRETCH, UPS } from '../scene/standing.js';
import { flag, formatNumber, number, numbers, text, texts, word, type Kind } from './kinds.js';
import { problemOfPose, type CameraNumbers } from './pose.js';

/// `auto`: the sun over terrains, a studio around all else. `matcap`: no light, the form alone. `relief`: scratches stand out.
export const LIGHTS = ['auto', 'studio', 'raking', 'relief', 'flat', 'sun', 'matcap'] as const;
export type LightName = (typeof LIGHTS)[number];

export interface LightChoice {
  readonly name: LightName;
  /// Where the key light comes from instead, radians to the right and up; null: as the name says.
  readonly key: readonly [number, number] | null;
}

export const COLOURS: readonly Colours[] = ['plain', 'vertex', 'partition', 'error', 'height', 'attribute'];
/// Levels of a hierarchy: there are no more.
export const MOST_LEVEL = 32;
/// A measured path has at most so many points.
export const MOST_MEASURED = 64;

const MOST_NAME = 100; // characters, of an attribute
const MOST_HIDDEN = 256; // labels
const MOST_TEXTS = 100; // objects
const ANGLE_DIGITS = 4;

export const VIEW_PARTS = ['camera', 'projection', 'look', 'standing', 'dollhouse', 'level', 'cut', 'rooms', 'pair', 'measure', 'pick', 'objects', 'notes', 'story'] as const;
export type ViewPart = (typeof VIEW_PARTS)[number];
type Box = readonly [number, number, number, number, number, number];

function isCamera(values: readonly number[]): boolean {
  return values.length === 6 && problemOfPose(values.slice(0, 3), values.slice(3)) === null;
}

function isBox(values: readonly number[]): boolean {
  return values.length === 6 && areNear(values) && [0, 1, 2].every((axis) => values[axis] < values[axis + 3]);
}

function isPlane(values: readonly number[]): boolean {
  return values.length === 4 && areNear(values) && values.slice(0, 3).some((value) => value !== 0);
}

function arePlaces(values: readonly number[]): boolean {
  return values.length > 0 && values.length % 3 === 0 && values.length <= 3 * MOST_MEASURED && areNear(values);
}

function isPair(values: readonly number[]): boolean {
  return values.length === 2;
}

function areAngles(values: readonly number[]): values is readonly [number, number] {
  return values.length === 2 && values.every((angle) => Math.abs(angle) <= Math.PI);
}

function formatLight({ name, key }: LightChoice): string {
  return [name, ...(key ?? []).map((angle) => formatNumber(angle, ANGLE_DIGITS))].join(',');
}

/// `isLenient`: a key light that cannot be is left out.
function parseLight(given: string, isLenient: boolean): LightChoice | null {
  const [name, ...angles] = given.split(',');
  const known = LIGHTS.find((each) => each === name);
  const key = angles.map((angle) => (angle.trim() === '' ? NaN : Number(angle)));
  if (known === undefined || (!isLenient && angles.length > 0 && !areAngles(key))) return null;
  return { name: known, key: areAngles(key) ? key : null };
}

const LIGHT: Kind<LightChoice> = {
  parse: ([given]) => parseLight(given ?? '', true),
  format: (light) => [formatLight(light)],
  read: (json) => parseLight(json.which(json.text(), (given) => parseLight(given, false) !== null, `one of ${LIGHTS.join(', ')}, perhaps with two angles`), false)!,
  toJson: formatLight,
};

interface Row<Value> {
  readonly part: ViewPart;
  readonly kind: Kind<Value>;
  /// The value of a view that does not say it; null: it has none.
  readonly otherwise: Value | null;
  /// In links alone.
  readonly isForLinks: boolean;
}

function row<Value>(part: ViewPart, kind: Kind<Value>, otherwise: Value | null = null, isForLinks = false): Row<Value> {
  return { part, kind, otherwise, isForLinks };
}

/// In the order of links.
export const VIEW_TABLE = {
  camera: row('camera', numbers<CameraNumbers>(isCamera, 'six numbers: a position and another place that is looked at')),
  projection: row('projection', word<Projection>(['perspective', 'parallel']), 'perspective'),
  colours: row('look', word(COLOURS), DEFAULT_LOOK.colours),
  shading: row('look', word(['smooth', 'flat'] as const), DEFAULT_LOOK.shading),
  attribute: row('look', text(({ length }) => length >= 1 && length <= MOST_NAME, `of 1 to ${MOST_NAME} characters`)),
  ramp: row('look', word(RAMPS), DEFAULT_LOOK.ramp),
  range: row('look', numbers<readonly [number, number]>(isPair, 'two numbers')),
  tolerance: row('look', number((value) => value > 0, 'a number above 0')),
  hidden: row('look', numbers(({ length }) => length <= MOST_HIDDEN, `at most ${MOST_HIDDEN} labels`), [] as readonly number[]),
  texture: row('look', flag(), DEFAULT_LOOK.texture),
  relight: row('look', flag(), DEFAULT_LOOK.relight),
  cavities: row('look', flag(), DEFAULT_LOOK.cavities),
  wires: row('look', flag(), DEFAULT_LOOK.wires),
  points: row('look', flag(), DEFAULT_LOOK.points),
  outline: row('look', flag(), DEFAULT_LOOK.outline),
  isolines: row('look', flag(), DEFAULT_LOOK.isolines),
  light: row('look', LIGHT, { name: 'auto', key: null }),
  occlusion: row('look', flag(), false),
  up: row('standing', word(UPS), DEFAULT_STANDING.up),
  stretch: row('standing', number((value) => value >= 1 && value <= MOST_STRETCH, `from 1 to ${MOST_STRETCH}`), DEFAULT_STANDING.stretch),
  /// Whether faces that look away are left out; `auto`: as the model is.
  dollhouse: row('dollhouse', word(['auto', 'on', 'off'] as const), 'auto'),
  level: row('level', number((value) => Number.isInteger(value) && value >= 0 && value <= MOST_LEVEL, `a whole number from 0 to ${MOST_LEVEL}`)),
  cut: row('cut', numbers<readonly [number, number, number, number]>(isPlane, 'four numbers: a normal that is not 0, and a distance')),
  box: row('cut', numbers<Box>(isBox, 'six numbers: the least corner, then the greatest')),
  caps: row('cut', flag(), true),
  walk: row('rooms', flag(), false, true),
  /// Heights of the input between which all is drawn.
  storey: row('rooms', numbers<readonly [number, number]>(([from, to, ...more]) => more.length === 0 && from < to, 'two numbers, the lower first')),
  way: row('pair', word(WAYS), 'swipe', true),
  /// The part of the picture's width that the first model has.
  divider: row('pair', number((value) => value >= 0 && value <= 1, 'from 0 to 1'), 0.5, true),
  measure: row('measure', numbers(arePlaces, `three numbers for each of 1 to ${MOST_MEASURED} points`)),
  pick: row('pick', numbers<readonly [number, number, number]>((values) => values.length === 3 && areNear(values), 'three numbers')),
  object: row('objects', text(() => true, 'a text')),
  by: row('objects', text(() => true, 'a text')),
  between: row('objects', numbers<readonly [number, number]>(isPair, 'two numbers')),
  only: row('objects', texts(MOST_TEXTS), [] as readonly string[]),
  hide: row('objects', texts(MOST_TEXTS), [] as readonly string[]),
  show: row('objects', texts(MOST_TEXTS), [] as readonly string[]),
  notes: row('notes', text(({ length }) => length > 0, 'a text'), null, true),
  story: row('story', number((value) => Number.isInteger(value) && value > 0, 'a whole number above 0'), null, true),
} as const;

export type ViewKey = keyof typeof VIEW_TABLE;

/// What is said of a view; what is undefined is as without a choice.
export type View = { readonly [Key in ViewKey]?: (typeof VIEW_TABLE)[Key] extends Row<infer Value> ? Value : never };

export const VIEW_KEYS = Object.keys(VIEW_TABLE) as readonly ViewKey[];

/// A row, whatever its values are.
export function rowOf(key: ViewKey): Row<unknown> {
  return VIEW_TABLE[key];
}

export function keysOf(...parts: readonly ViewPart[]): ViewKey[] {
  return VIEW_KEYS.filter((key) => parts.includes(VIEW_TABLE[key].part));
}

/// Tells whether a view says anything of a part.
export function says(view: View, part: ViewPart): boolean {
  return keysOf(part).some((key) => view[key] !== undefined);
}

/// Tells whether a value is what a view has that does not say it.
export function isOtherwise(key: ViewKey, value: unknown): boolean {
  const { kind, otherwise } = rowOf(key);
  return value === undefined || value === null || (otherwise !== null && JSON.stringify(kind.format(value)) === JSON.stringify(kind.format(otherwise)));
}

/// A value, or what a view has without it.
export function valueOf<Key extends ViewKey>(view: View, key: Key): NonNullable<View[Key]> | null {
  return (view[key] ?? VIEW_TABLE[key].otherwise) as NonNullable<View[Key]> | null;
}
