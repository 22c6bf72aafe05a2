// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { formatNotes, MOST_ENTRIES, NotesProblem, readNotes, type Notebook } from '../../src/tools/notes.js';

const STORY: Notebook = {
  title: 'Zwei Orte',
  notes: [
    { at: [1e-7, -691000.123456789, 5e-324], text: 'Riß <b>„hier“</b>\n裂け目', view: { position: [1, 2, 3], target: [0.1, 0.2, 0.3], choices: 'light=raking&wires=on' }, picture: 'pictures/1.jpg', link: 'https://example.org/?a=1' },
    { at: [0, 0, 0], text: '' },
    { at: [0, 0, 1], text: 'x', view: { position: [0, 0, 9], target: [0, 0, 1], choices: '' } },
  ],
  bookmarks: [{ name: 'from above', position: [0, 10, 0.1], target: [0, 0, 0] }],
};

interface Annotation { id: string; type: string; motivation: unknown; body: unknown; target: unknown }

function changed(change: (page: { type: unknown; items: Annotation[]; label: unknown }) => void): string {
  const page = JSON.parse(formatNotes(STORY, 'a')) as Parameters<typeof change>[0];
  change(page);
  return JSON.stringify(page);
}

/// As the IIIF 3D group writes comments with a camera each; shortened, in other words.
const OTHERS = JSON.stringify({
  '@context': 'http://iiif.io/api/presentation/4/context.json',
  id: 'https://example.org/page/1',
  type: 'AnnotationPage',
  items: [
    { id: 'https://example.org/model', type: 'Annotation', motivation: ['painting'], body: { id: 'a.glb', type: 'Model' }, target: { id: 'https://example.org/scene', type: 'Scene' } },
    { id: 'https://example.org/camera', type: 'Annotation', motivation: ['painting'], body: { type: 'PerspectiveCamera', label: { en: ['Glove'] }, lookAt: { type: 'PointSelector', x: 1, y: 2 } }, target: { type: 'SpecificResource', source: { id: 'https://example.org/scene', type: 'Scene' }, selector: [{ type: 'PointSelector', x: 1, y: 2, z: 9 }] } },
    { id: 'https://example.org/free', type: 'Annotation', motivation: 'painting', body: [{ type: 'PerspectiveCamera' }], target: { selector: { type: 'PointSelector', z: 4 } } },
    { id: 'https://example.org/note', type: 'Annotation', motivation: ['commenting'], body: { type: 'TextualBody', value: '<p>A  <i>glove</i>.</p>', format: 'text/html' }, target: { type: 'SpecificResource', selector: [{ type: 'PointSelector', x: 1.075, y: 1.894, z: 0.204 }], scope: [{ type: 'Annotation', motivation: ['contentState'], target: { id: 'https://example.org/camera', type: 'Annotation' } }] } },
    { id: 'https://example.org/plain', type: 'Annotation', bodyValue: 'plain', target: [{ selector: { type: 'PointSelector', x: 1, y: 1, z: 1 } }] },
    { id: 'https://example.org/whole', type: 'Annotation', body: 'https://example.org/text', target: 'https://example.org/scene' },
  ],
});

describe('a page of annotations', () => {
  it('holds a story, to the bit', () => {
    expect(readNotes(formatNotes(STORY, 'model'))).toEqual(STORY);
  });

  it('is what IIIF and the Web Annotation model have for it', () => {
    const { items, ...page } = JSON.parse(formatNotes(STORY, 'model')) as { items: Annotation[] };
    expect(page).toMatchObject({ type: 'AnnotationPage', '@context': 'http://iiif.io/api/presentation/4/context.json', label: { none: ['Zwei Orte'] } });
    expect(items.map(({ motivation }) => String(motivation))).toEqual(['painting', 'commenting', 'commenting', 'painting', 'commenting', 'painting']);
    expect(new Set(items.map(({ id }) => id)).size).toBe(items.length);
  });

  it('of others gives its comments at points, and its cameras', () => {
    expect(readNotes(OTHERS)).toEqual({
      title: '',
      notes: [
        { at: [1.075, 1.894, 0.204], text: 'A glove .', view: { position: [1, 2, 9], target: [1, 2, 0], choices: '' } },
        { at: [1, 1, 1], text: 'plain' },
      ],
      bookmarks: [{ name: '', position: [0, 0, 4], target: [0, 0, 0] }],
      leftOut: 1, // the comment at no point
    });
  });

  it.each([
    ['another type', changed((page) => { page.type = 'Collection'; })],
    ['a point farther away than any', changed((page) => { page.items[2].target = { selector: [{ type: 'PointSelector', x: 1e300 }] }; })],
    ['a camera farther away than any', changed((page) => { page.items[0].target = { selector: [{ type: 'PointSelector', x: -2e30 }] }; })],
    ['a polygon with half a corner', changed((page) => { page.items[2].target = { selector: { type: 'PolygonZSelector', value: 'POLYGONZ((0 0 0, 1))' } }; })],
    ['a polygon far away', changed((page) => { page.items[2].target = { selector: { type: 'PolygonZSelector', value: 'POLYGONZ((0 0 0, 1 1e300 1))' } }; })],
    ['no type', changed((page) => { page.type = undefined; })],
    ['no list', changed((page) => { page.items = {} as Annotation[]; })],
    ['no number', changed((page) => { page.items[2].target = { selector: [{ type: 'PointSelector', x: 'a' }] }; })],
    ['a text that is none', changed((page) => { page.items[2].body = { type: 'TextualBody', value: 7 }; })],
    ['a title that is none', changed((page) => { page.label = 7; })],
    ['too many notes', changed((page) => { page.items = Array.from({ length: MOST_ENTRIES + 1 }, () => page.items[2]); })],
    ['too many of all', changed((page) => { page.items = Array.from({ length: 3 * MOST_ENTRIES + 1 }, () => ({ ...page.items[2], target: '' })); })],
  ])('is refused: %s', (_, text) => {
    expect(() => readNotes(text)).toThrow(NotesProblem);
  });

  it.each([
    ['no items of a kind that is known', (page: { items: Annotation[] }) => { page.items = [null, 7, 'x', [], {}].map((item) => item as unknown as Annotation); }],
    ['bodies of any kind', (page: { items: Annotation[] }) => { page.items[2].body = [null, 7, 'x', {}]; }],
    ['a scope that is none', (page: { items: Annotation[] }) => { page.items[2].target = { selector: { type: 'PointSelector' }, scope: [null] }; }],
    ['an empty scope', (page: { items: Annotation[] }) => { page.items[2].target = { selector: { type: 'PointSelector' }, scope: [] }; }],
    ['a camera that is none', (page: { items: Annotation[] }) => { page.items[0].body = { type: 'PerspectiveCamera', lookAt: null }; }],
  ])('is read without what is not understood: %s', (_, change) => {
    const story = changed(change);
    try {
      expect(readNotes(story).notes.length).toBeLessThanOrEqual(STORY.notes.length);
    } catch (problem) {
      expect(problem).toBeInstanceOf(NotesProblem);
    }
  });
});
