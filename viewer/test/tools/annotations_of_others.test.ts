// SPDX-License-Identifier: MIT
// Annotations as IIIF's 3D group and the Web Annotation model write them.
import { describe, expect, it } from 'vitest';
import { readNotes, type Notebook } from '../../src/tools/notes.js';

type Json = Readonly<Record<string, unknown>>;

const SCENE = { id: 'https://example.org/scene', type: 'Scene' };

function at(x: number, y: number, z: number, more: Json = {}): Json {
  return { type: 'SpecificResource', source: [SCENE], selector: [{ type: 'PointSelector', x, y, z }], ...more };
}

function said(value: string, language: string | null = null): Json {
  return { type: 'TextualBody', value, ...(language === null ? {} : { language }) };
}

function comment(id: string, body: unknown, target: unknown = at(1, 2, 3), motivation: unknown = ['commenting']): Json {
  return { id, type: 'Annotation', motivation, body, target };
}

function camera(id: string, body: Json, target: unknown, transform: readonly Json[] = []): Json {
  return { id, type: 'Annotation', motivation: ['painting'], body: { type: 'SpecificResource', source: [{ type: 'PerspectiveCamera', ...body }], transform }, target };
}

const MODEL = { id: 'model', type: 'Annotation', motivation: ['painting'], body: { type: 'SpecificResource', source: { id: 'a.glb', type: 'Model' } }, target: SCENE };

function page(...items: readonly unknown[]): Json {
  return { type: 'AnnotationPage', items };
}

function read(document: Json, ...languages: readonly string[]): Notebook {
  return readNotes(JSON.stringify(document), languages);
}

function texts(document: Json, ...languages: readonly string[]): string[] {
  return read(document, ...languages).notes.map(({ text }) => text);
}

describe('a choice of texts', () => {
  const choice = { type: 'Choice', items: [said('Glove', 'en'), said('Guante', 'es'), said('Handschuh', 'de')] };
  const glove = page(comment('1', [choice]));

  it.each([
    [['es'], 'Guante'], [['de-AT'], 'Handschuh'], [['fr', 'de', 'en'], 'Handschuh'], [['fr'], 'Glove'], [[], 'Glove'],
  ])('for readers of %j is %s', (languages, text) => { expect(texts(glove, ...languages)).toEqual([text]); });

  it('has what is in no language before what is in another one', () => {
    expect(texts(page(comment('1', { type: 'Choice', items: [said('Gant', 'fr'), said('a glove')] })), 'de')).toEqual(['a glove']);
  });

  it('may be among other bodies, and within a resource', () => {
    const body = [{ type: 'SpecificResource', source: choice }, { id: 'a.jpg', type: 'Image' }, said('!')];
    expect(read(page(comment('1', body)), 'es').notes).toEqual([{ at: [1, 2, 3], text: 'Guante\n!', picture: 'a.jpg' }]);
  });

  it('may stand where a text is meant to', () => {
    expect(texts(page({ ...comment('1', []), bodyValue: said('Helmet', 'en') }))).toEqual(['Helmet']);
    expect(texts(page({ ...comment('1', []), bodyValue: 'plain' }))).toEqual(['plain']);
  });

  it('holds for titles, too', () => {
    const label = { en: ['A scene'], es: ['Una escena'] };
    expect(read({ ...glove, label }, 'es-MX').title).toBe('Una escena');
    expect(read({ ...glove, label }, 'de').title).toBe('A scene');
    expect(read({ ...glove, label: { none: ['x'], en: ['y'] } }, 'de').title).toBe('x');
  });

  it('within choices without end is nothing', () => {
    let body: Json = said('deep');
    for (let i = 0; i < 50; ++i) body = { type: 'Choice', items: [body] };
    expect(texts(page(comment('1', body)))).toEqual(['']);
  });
});

describe('what is no comment', () => {
  it.each(['painting', 'tagging', 'highlighting', 'linking', ['supplementing'], ['contentState', 'activating']])('is left out and counted: %s', (motivation) => {
    const { notes, leftOut } = read(page(comment('1', said('x'), at(0, 0, 0), motivation), comment('2', said('a comment'))));
    expect(notes.map(({ text }) => text)).toEqual(['a comment']);
    expect(leftOut).toBe(1);
  });

  it('is not counted where it is the model', () => {
    expect(read(page(MODEL, comment('1', said('x'))))).not.toHaveProperty('leftOut');
  });

  it('is counted whatever it is', () => {
    const light = { id: 'light', type: 'Annotation', motivation: ['painting'], body: { type: 'AmbientLight' }, target: SCENE };
    expect(read(page(light, null, 7, [], {}, comment('1', said('of all'), SCENE), camera('nowhere', {}, SCENE))).leftOut).toBe(7);
  });

  it('is a comment with another motivation beside that', () => {
    expect(texts(page(comment('1', said('x'), at(0, 0, 0), ['highlighting', 'commenting'])))).toEqual(['x']);
  });
});

describe('a camera in a resource', () => {
  const towards = (transform: readonly Json[], place: unknown = at(0, 0, 0)): number[] => {
    const [{ position, target }] = read(page(camera('c', {}, place, transform))).bookmarks;
    return target.map((value, axis) => Number((value - position[axis]).toFixed(3)) + 0);
  };
  const turn = (x: number, y: number, z: number): Json => ({ type: 'RotateTransform', x, y, z });

  it.each([
    [[], [0, 0, -1]], [[turn(0, 90, 0)], [-1, 0, 0]], [[turn(90, 0, 0)], [0, 1, 0]], [[turn(0, 0, 90)], [0, 0, -1]],
    [[turn(90, 90, 0)], [-1, 0, 0]], // x, then y around the axis that x has left
    [[turn(90, 0, 0), turn(0, 90, 0)], [0, 1, 0]], // one after the other, around the scene's axes
    [[{ type: 'ScaleTransform', x: 5, y: 5, z: 5 }, turn(0, 180, 0)], [0, 0, 1]],
    [[{ type: 'RotateTransform', y: -90 }], [1, 0, 0]],
  ])('looks where %j turns it', (transform, direction) => { expect(towards(transform)).toEqual(direction); });

  it('looks at what it was turned to by hand', () => { // the whale's hamulus, as IIIF's example has it
    const { notes } = read(page(camera('c', {}, at(-0.25, 0, -0.5), [turn(-15, 215, 0)]), comment('1', said('hamulus'), at(0.04, 0.063, -0.066, { scope: 'c' }))));
    const { target } = notes[0].view!;
    expect(Math.hypot(target[0] - 0.04, target[1] - 0.063, target[2] + 0.066)).toBeLessThan(0.07);
  });

  it('is moved by what its resource is moved', () => {
    const { bookmarks: [{ position }] } = read(page(camera('c', {}, at(1, 0, 0), [{ type: 'TranslateTransform', z: 2 }, turn(0, 90, 0)])));
    expect(position.map((value) => Math.round(value))).toEqual([3, 0, 0]);
  });

  it('has its name from its body', () => {
    expect(read(page(camera('c', { label: { en: ['From above'] } }, at(0, 9, 0)))).bookmarks[0].name).toBe('From above');
  });

  it.each([
    ['a point', { type: 'PointSelector', x: 5, y: 6, z: 7 }],
    ['a point of a resource', at(5, 6, 7)],
    ['an annotation', { id: 'https://example.org/note', type: 'Annotation' }],
    ['an annotation, by its address', 'https://example.org/note'],
    ['a polygon', { type: 'PolygonZSelector', value: 'POLYGONZ((4 6 7, 5 5 7, 6 6 7, 5 7 7))' }],
  ])('may look at %s', (_, lookAt) => {
    const { bookmarks: [{ target }] } = read(page(camera('c', { lookAt }, at(0, 0, 9)), comment('https://example.org/note', said(''), at(5, 6, 7))));
    expect(target).toEqual([5, 6, 7]);
  });

  it('looks at the origin where what it looks at is at no point', () => {
    expect(read(page(MODEL, camera('c', { lookAt: { id: 'model', type: 'Annotation' } }, at(0, 3, -10)))).bookmarks[0].target).toEqual([0, 0, 0]);
  });

  it('may be among those that there is a choice of', () => {
    expect(read(page({ id: 'choice', type: 'Choice', items: [camera('a', {}, at(0, 0, 1)), camera('b', {}, at(0, 0, 2))] })).bookmarks).toHaveLength(2);
  });

  it('without a name of its own is one of several', () => {
    expect(read(page(camera('', {}, at(0, 0, 1)), camera('', {}, at(0, 0, 2)))).bookmarks).toHaveLength(2);
  });
});

describe('a manifest', () => {
  const scene = { ...SCENE, items: [page(MODEL, camera('c', {}, at(0, 0, 5)))], annotations: [page(comment('1', said('in the scene'), at(0, 0, 0, { scope: [{ id: 's', type: 'Annotation', motivation: ['contentState'], target: { id: 'c', type: 'Annotation' } }] })))] };
  const manifest = { '@context': 'http://iiif.io/api/presentation/4/context.json', id: 'm', type: 'Manifest', label: { en: ['A whale'] }, items: [scene], annotations: [page(comment('2', said('of the whole')))] };

  it('is read with all its pages', () => {
    expect(read(manifest)).toEqual({
      title: 'A whale',
      notes: [{ at: [1, 2, 3], text: 'of the whole' }, { at: [0, 0, 0], text: 'in the scene', view: { position: [0, 0, 5], target: [0, 0, 0], choices: '' } }],
      bookmarks: [],
    });
  });

  it('may be a scene alone', () => { expect(texts(scene)).toEqual(['in the scene']); });

  it('names pages that are elsewhere, which are counted', () => {
    expect(read({ ...manifest, annotations: [{ id: 'https://example.org/page/9', type: 'AnnotationPage' }, 'x', null] })).toMatchObject({ leftOut: 1 });
  });

  it('may have the camera of a comment within its scope', () => {
    for (const items of [[camera('', {}, at(0, 0, 8))], [page(camera('', {}, at(0, 0, 8)))]]) {
      const within = { type: 'Annotation', motivation: ['contentState'], target: { ...SCENE, items } };
      expect(read(page(comment('1', said('x'), at(0, 0, 2, { scope: within })))).notes[0].view).toEqual({ position: [0, 0, 8], target: [0, 0, 2], choices: '' });
    }
  });

  it('may give a comment its camera by another annotation', () => {
    const activating = { id: 'a', type: 'Annotation', motivation: ['activating'], target: { id: '1', type: 'Annotation' }, body: { type: 'SpecificResource', source: { id: 'c', type: 'Annotation' }, action: ['show'] } };
    const older = { ...activating, target: 'c', body: '1', enables: 'c' };
    for (const each of [activating, older]) {
      const { notes, bookmarks, leftOut } = read(page(camera('c', {}, at(0, 0, 9)), comment('1', said('x'), at(0, 0, 1)), each));
      expect(notes[0].view).toEqual({ position: [0, 0, 9], target: [0, 0, 1], choices: '' });
      expect([bookmarks, leftOut]).toEqual([[], undefined]);
    }
  });
});

describe('a place', () => {
  const placeOf = (target: unknown): readonly number[] | undefined => read(page(comment('1', said('x'), target))).notes[0]?.at;
  const shape = (value: string, type = 'WKTSelector'): Json => ({ type: 'SpecificResource', source: SCENE, selector: [{ type, value }] });

  it.each([
    ['POLYGON Z ((0 0 1, 2 0 1, 2 2 1, 0 2 1, 0 0 1))', [1, 1, 1]], // the corner that closes it counts once
    ['POLYGONZ((0 0 1, 2 0 1, 2 2 1, 0 2 1))', [1, 1, 1]],
    ['polygon z((0 0 0, 3 0 0, 0 3 0))', [1, 1, 0]],
    ['POLYGON Z ((0 0 0, 0.1 0 0, 0.2 0 0, 0.3 0 0, 2 0 0, 2 2 0, 0 2 0))', [1, 1, 0]], // of the area, however many corners there are where
    ['POLYGON Z ((0 0 0, 4 0 0, 4 4 0, 0 4 0), (1 1 0, 2 1 0, 2 2 0))', [2, 2, 0]],
    ['POLYGON ((0 0, 2 0, 2 2, 0 2))', [1, 1, 0]],
    ['LINESTRING Z (0 0 0, 2 4 6)', [1, 2, 3]],
    ['POINT Z (1 2 3)', [1, 2, 3]],
    ['POLYGON Z ((1 1 1, 1 1 1, 1 1 1))', [1, 1, 1]],
  ])('of %s is in its middle', (value, middle) => {
    for (const type of ['WKTSelector', 'WktSelector', 'PolygonZSelector']) expect(placeOf(shape(value, type))!.map((each) => Number(each.toFixed(9)))).toEqual(middle);
  });

  it.each(['https://example.org/scene#xyz=1,2,3', { id: 'https://example.org/scene#xyz=1,2,3', type: 'Scene' }, 'https://example.org/scene#t=4&xyz=1,2,3', { type: 'SpecificResource', source: 'https://example.org/scene#xyz=1,2,3' }])('may be in an address: %j', (target) => {
    expect(placeOf(target)).toEqual([1, 2, 3]);
  });

  it.each([shape('CURVEPOLYGON((0 0 0))'), shape('', 'FragmentSelector'), 'https://example.org/scene#xyz=1,2,', 'https://example.org/scene#xyz=1e300,0,0', [], null])('is none of %j', (target) => {
    expect(read(page(comment('1', said('x'), target))).leftOut).toBe(1);
  });
});
