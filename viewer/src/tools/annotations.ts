// SPDX-License-Identifier: MIT
// A story as a page of annotations: W3C Web Annotations with the cameras and points that IIIF's Presentation API 4 has for
// scenes. Points are in the input's coordinates. Of other people's pages, scenes and manifests the comments at points are read, and the
// cameras; all else is counted, but for the models, which are shown.
import type { Fail, Json, JsonValue } from '../json_value.js';
import { bodiesOf, labelOf, saidBy, type Languages } from './annotation_bodies.js';
import { cameraBodyOf, CHOICES, readCamera, type Camera } from './annotation_cameras.js';
import { annotationsIn, annotationsWithin, DOCUMENTS } from './annotation_pages.js';
import { idOf, isOfType, targetOf as placeOf } from './annotation_points.js';
import { MOST_ENTRIES, type Bookmark, type Note, type Notebook, type SeenFrom } from './note.js';
import type { Vector } from './vectors.js';

const CONTEXT = 'http://iiif.io/api/presentation/4/context.json';
/// Degrees from the lower to the upper edge of the picture.
const FIELD_OF_VIEW = 45;
/// Notes, their cameras and bookmarks.
const MOST_ANNOTATIONS = 3 * MOST_ENTRIES;

// ---- writing

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

function motivationsOf(annotation: JsonValue): readonly string[] {
  if (!annotation.has('motivation')) return [];
  return annotation.at('motivation').oneOrMore().flatMap((each) => (each.isText() ? [each.text()] : []));
}

/// One that does not say why it was made is a comment.
function isComment(annotation: JsonValue): boolean {
  const motivations = motivationsOf(annotation);
  return motivations.length === 0 || motivations.includes('commenting');
}

class Reader {
  readonly notes: Note[] = [];
  private readonly byId = new Map<string, JsonValue>();
  private readonly cameras: Camera[] = [];
  private readonly used = new Set<Camera>();
  /// The cameras that other annotations give to comments, by the comments' ids.
  private readonly given = new Map<string, Camera>();
  private readonly leftOut: JsonValue[] = [];

  constructor(
    items: readonly JsonValue[],
    private readonly languages: Languages,
    private readonly refuse: Fail,
  ) {
    for (const item of items) if (idOf(item) !== '' && !this.byId.has(idOf(item))) this.byId.set(idOf(item), item);
    const others = items.filter((item) => !this.takeCamera(item));
    for (const item of others.filter((each) => !this.takeActivation(each))) this.takeOther(item);
  }

  get bookmarks(): Bookmark[] {
    return this.cameras.filter((camera) => !this.used.has(camera)).map(({ name, seen }) => {
      const { position, target } = seen(null);
      return { name, position, target };
    });
  }

  get leftOutCount(): number {
    return this.leftOut.length;
  }

  /// False: it has none. One that stands at no point is left out.
  private takeCamera(item: JsonValue): boolean {
    const body = cameraBodyOf(item, this.languages);
    if (body === undefined) return false;
    const camera = readCamera(item, body, this.byId, this.languages, this.refuse);
    if (camera === null) this.leftOut.push(item);
    else this.cameras.push(camera);
    return true;
  }

  /// One that shows a camera when a comment is chosen.
  private takeActivation(item: JsonValue): boolean {
    if (!item.isObject() || !motivationsOf(item).includes('activating')) return false;
    const targets = item.has('target') ? item.at('target').oneOrMore().map(idOf) : [];
    const ids = [...bodiesOf(item, this.languages).map(({ value }) => idOf(value)), ...targets]; // drafts have it either way round
    const camera = ids.map((id) => this.cameraOf(id)).find((each) => each !== undefined);
    if (camera === undefined) return false;
    for (const id of ids) this.given.set(id, camera);
    return true;
  }

  private takeOther(item: JsonValue): void {
    const at = item.isObject() && isComment(item) ? placeOf(item, this.refuse) : null;
    if (at !== null) this.notes.push(this.noteOf(item, at));
    else if (!this.isModel(item)) this.leftOut.push(item);
  }

  /// That is what is shown.
  private isModel(item: JsonValue): boolean {
    return bodiesOf(item, this.languages).some(({ value }) => isOfType(value, 'Model'));
  }

  private noteOf(item: JsonValue, at: Note['at']): Note {
    const camera = this.scopeOf(item) ?? this.given.get(idOf(item));
    if (camera !== undefined) this.used.add(camera);
    const { text, picture, link } = saidBy(item, this.languages);
    return {
      at,
      text,
      ...(camera === undefined ? {} : { view: camera.seen(at) }),
      ...(picture === undefined ? {} : { picture }),
      ...(link === undefined ? {} : { link }),
    };
  }

  private cameraOf(id: string): Camera | undefined {
    return id === '' ? undefined : this.cameras.find((camera) => camera.id === id);
  }

  /// The camera that the target's scope names, or has within it.
  private scopeOf(item: JsonValue): Camera | undefined {
    const [target] = item.at('target').oneOrMore();
    if (!target.isObject() || !target.has('scope')) return undefined;
    const [scope] = target.at('scope').oneOrMore();
    if (scope === undefined) return undefined;
    if (!scope.isObject() || !scope.has('target')) return this.cameraOf(idOf(scope));
    const [state] = scope.at('target').oneOrMore();
    return state === undefined ? undefined : (this.cameraOf(idOf(state)) ?? this.cameraWithin(state));
  }

  /// In a scene that is as it is for one comment.
  private cameraWithin(scene: JsonValue): Camera | undefined {
    for (const item of annotationsWithin(scene)) {
      const body = cameraBodyOf(item, this.languages);
      const camera = body && readCamera(item, body, this.byId, this.languages, this.refuse);
      if (camera) return camera;
    }
    return undefined;
  }
}

/// `languages`: the reader's, the one that is wanted most first.
export function readAnnotations(root: JsonValue, languages: Languages, refuse: Fail): Notebook {
  root.at('type').oneOf(...DOCUMENTS);
  const { items, pagesElsewhere } = annotationsIn(root);
  if (items.length > MOST_ANNOTATIONS) refuse(`more than ${MOST_ANNOTATIONS} annotations`);
  const { notes, bookmarks, leftOutCount } = new Reader(items, languages, refuse);
  if (notes.length > MOST_ENTRIES || bookmarks.length > MOST_ENTRIES) refuse(`more than ${MOST_ENTRIES} entries`);
  const leftOut = leftOutCount + pagesElsewhere;
  return { title: labelOf(root, languages), notes, bookmarks, ...(leftOut === 0 ? {} : { leftOut }) };
}
