// SPDX-License-Identifier: MIT
// A story as a page of annotations: W3C Web Annotations with the cameras and points that IIIF's Presentation API 4 has for
// scenes. Points are in the input's coordinates. Of other people's pages the comments at points are read, and the cameras.
import type { Fail, JsonValue } from '../json_value.js';
import { MOST_ENTRIES, MOST_TEXT, type Bookmark, type Note, type Notebook, type SeenFrom } from './note.js';
import type { Vector } from './vectors.js';

const CONTEXT = 'http://iiif.io/api/presentation/4/context.json';
/// How what a camera sees is shown: a property of this program's own.
const CHOICES = 'meshhier:choices';
/// Degrees from the lower to the upper edge of the picture.
const FIELD_OF_VIEW = 45;
/// Notes, their cameras and bookmarks.
const MOST_ANNOTATIONS = 3 * MOST_ENTRIES;

// ---- writing

type Json = Readonly<Record<string, unknown>>;

function pointOf([x, y, z]: Vector): Json {
  return { type: 'PointSelector', x, y, z };
}

function targetOf(at: Vector, more: Json = {}): Json {
  return { type: 'SpecificResource', source: { id: '#scene', type: 'Scene' }, selector: [pointOf(at)], ...more };
}

function cameraOf(id: string, label: string, { position, target, choices }: SeenFrom): Json {
  const body = { type: 'PerspectiveCamera', fieldOfView: FIELD_OF_VIEW, lookAt: pointOf(target), ...(choices === '' ? {} : { [CHOICES]: choices }) };
  return { id, type: 'Annotation', motivation: ['painting'], behavior: ['hidden'], label: { none: [label] }, body, target: targetOf(position) };
}

/// The camera comes before the note that is seen from it.
function annotationsOfNote({ at, text, view, picture, link }: Note, number: number): Json[] {
  const camera = `#view-${number}`;
  const bodies = [
    { type: 'TextualBody', value: text, format: 'text/plain' },
    ...(picture ? [{ id: picture, type: 'Image' }] : []),
    ...(link ? [{ id: link, type: 'Text', purpose: 'linking' }] : []),
  ];
  const scope = view ? { scope: [{ id: `#scope-${number}`, type: 'Annotation', motivation: ['contentState'], target: { id: camera, type: 'Annotation' } }] } : {};
  const note = { id: `#note-${number}`, type: 'Annotation', motivation: ['commenting'], body: bodies, target: targetOf(at, scope) };
  return view ? [cameraOf(camera, text, view), note] : [note];
}

/// `model`: the title of a story without one.
export function annotationsOf({ title, notes, bookmarks }: Notebook, model: string): Json {
  const marks = bookmarks.map(({ name, position, target }, i) => cameraOf(`#bookmark-${i + 1}`, name, { position, target, choices: '' }));
  const items = [...notes.flatMap((note, i) => annotationsOfNote(note, i + 1)), ...marks];
  return { '@context': CONTEXT, id: '#story', type: 'AnnotationPage', label: { none: [title || model] }, items };
}

// ---- reading

interface Camera {
  readonly id: string;
  readonly name: string;
  readonly seen: SeenFrom;
}

function shortened(text: string): string {
  return text.slice(0, MOST_TEXT);
}

function idOf(value: JsonValue): string {
  if (value.isText()) return value.text();
  return value.isObject() && value.at('id').isText() ? value.at('id').text() : '';
}

function isOfType(value: JsonValue, type: string): boolean {
  return value.isObject() && value.at('type').isText(type);
}

/// The first text of a map of languages.
function labelOf(value: JsonValue): string {
  if (!value.has('label')) return '';
  const label = value.at('label');
  if (label.isText()) return shortened(label.text());
  const [, first] = label.entries()[0] ?? [];
  const text = first?.oneOrMore()[0];
  return text?.isText() ? shortened(text.text()) : '';
}

function readPoint(point: JsonValue): Vector {
  const along = (axis: string): number => (point.has(axis) ? point.at(axis).number() : 0);
  return [along('x'), along('y'), along('z')];
}

/// Null: it is at no point.
function readTarget(annotation: JsonValue): Vector | null {
  if (!annotation.has('target')) return null;
  const [target] = annotation.at('target').oneOrMore();
  if (!target?.isObject() || !target.has('selector')) return null;
  const point = target.at('selector').oneOrMore().find((selector) => isOfType(selector, 'PointSelector'));
  return point === undefined ? null : readPoint(point);
}

function bodiesOf(annotation: JsonValue): JsonValue[] {
  return annotation.has('body') ? annotation.at('body').oneOrMore() : [];
}

/// One without something to look at looks the way cameras of IIIF and glTF do.
function readCamera(annotation: JsonValue): Camera | null {
  const body = bodiesOf(annotation).find((each) => isOfType(each, 'PerspectiveCamera'));
  const position = readTarget(annotation);
  if (body === undefined || position === null) return null;
  const looksAt = body.has('lookAt') && isOfType(body.at('lookAt'), 'PointSelector');
  const target: Vector = looksAt ? readPoint(body.at('lookAt')) : [position[0], position[1], position[2] - 1];
  const choices = body.has(CHOICES) ? shortened(body.at(CHOICES).text()) : '';
  return { id: idOf(annotation), name: labelOf(annotation) || labelOf(body), seen: { position, target, choices } };
}

/// Marks of a text in HTML are left out: the words are what counts.
function textOf(body: JsonValue): string {
  const text = body.at('value').text();
  return body.has('format') && body.at('format').isText('text/html') ? text.replace(/<[^<>]*>/g, ' ').replace(/\s+/g, ' ').trim() : text;
}

function readText(annotation: JsonValue): string {
  if (annotation.has('bodyValue')) return shortened(annotation.at('bodyValue').text());
  const texts = bodiesOf(annotation).filter((body) => isOfType(body, 'TextualBody'));
  return shortened(texts.map(textOf).join('\n'));
}

/// The camera's id; none: ''.
function scopeOf(annotation: JsonValue): string {
  const [target] = annotation.at('target').oneOrMore();
  if (!target.has('scope')) return '';
  const [scope] = target.at('scope').oneOrMore();
  if (scope === undefined) return '';
  if (!scope.isObject() || !scope.has('target')) return idOf(scope);
  const [camera] = scope.at('target').oneOrMore();
  return camera === undefined ? '' : idOf(camera);
}

function readNote(annotation: JsonValue, cameras: ReadonlyMap<string, Camera>): Note | null {
  const at = readTarget(annotation);
  if (at === null) return null;
  const bodies = bodiesOf(annotation);
  const picture = bodies.find((body) => isOfType(body, 'Image'));
  const link = bodies.find((body) => body.isObject() && body.at('purpose').isText('linking'));
  const view = cameras.get(scopeOf(annotation))?.seen;
  return {
    at,
    text: readText(annotation),
    ...(view === undefined ? {} : { view }),
    ...(picture === undefined ? {} : { picture: idOf(picture) }),
    ...(link === undefined ? {} : { link: shortened(idOf(link)) }),
  };
}

/// What is no comment at a point and no camera is left out.
export function readAnnotations(root: JsonValue, refuse: Fail): Notebook {
  root.at('type').oneOf('AnnotationPage');
  const items = root.at('items').items();
  if (items.length > MOST_ANNOTATIONS) refuse(`more than ${MOST_ANNOTATIONS} annotations`);
  const isCamera = (item: JsonValue): boolean => bodiesOf(item).some((body) => isOfType(body, 'PerspectiveCamera'));
  const cameras = new Map(items.filter(isCamera).flatMap((item) => readCamera(item) ?? []).map((camera) => [camera.id, camera]));
  const notes = items.filter((item) => !isCamera(item)).flatMap((item) => readNote(item, cameras) ?? []);
  const used = new Set(items.filter((item) => !isCamera(item) && readTarget(item) !== null).map(scopeOf));
  const bookmarks: Bookmark[] = [...cameras.values()].filter(({ id }) => !used.has(id)).map(({ name, seen: { position, target } }) => ({ name, position, target }));
  if (notes.length > MOST_ENTRIES || bookmarks.length > MOST_ENTRIES) refuse(`more than ${MOST_ENTRIES} entries`);
  return { title: labelOf(root), notes, bookmarks };
}
