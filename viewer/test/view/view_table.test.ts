// SPDX-License-Identifier: MIT
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { formatAddress, parseAddress } from '../../page/address.js';
import { JsonValue } from '../../src/json_value.js';
import { cameraOf, poseOf } from '../../src/view/pose.js';
import { besideFirst, fittedLink, orderedLink, overFirst, partsOf, readLink, writeLink } from '../../src/view/view_link.js';
import { readView, viewToJson } from '../../src/view/view_json.js';
import type { View } from '../../src/view/view_table.js';

interface Case {
  readonly link?: string;
  readonly view: unknown;
  readonly exact?: boolean;
  readonly becomes?: unknown;
  readonly problem?: string;
}

const { views } = JSON.parse(readFileSync(new URL('../../../tests/data/views.json', import.meta.url), 'utf8')) as { views: Case[] };
const links = views.filter((each): each is Case & { link: string } => each.link !== undefined);
const jsons = views.filter(({ link }) => link === undefined);

function refuse(what: string): never {
  throw new Error(what);
}

const read = (view: unknown): View => readView(JsonValue.of(view, 'view', refuse));

function viewOfAddress(link: string): View {
  const { pose, choices } = parseAddress(link)!;
  return { ...(pose && { camera: cameraOf(pose) }), ...readLink(choices) };
}

function addressOf({ camera, ...others }: View, path: string): string {
  return formatAddress({ path, pose: camera === undefined ? null : poseOf(camera), choices: writeLink(others) });
}

describe('what programs agree on', () => {
  it('is there', () => { expect([links.length > 30, jsons.length > 30]).toEqual([true, true]); });

  it.each(links.filter(({ link }) => link !== '#'))('is read from the link $link', ({ link, view }) => { expect(viewToJson(viewOfAddress(link))).toEqual(view); });

  it.each(links.filter(({ exact }) => exact))('is written as the link $link', ({ link, view }) => {
    expect(addressOf(read(view), parseAddress(link)!.path)).toBe(link);
    expect(viewToJson(read(view))).toEqual(view);
  });

  it.each(jsons.filter(({ becomes }) => becomes !== undefined))('is the JSON $view', ({ view, becomes }) => { expect(viewToJson(read(view))).toEqual(becomes); });

  it.each(jsons.filter(({ problem }) => problem !== undefined))('is not the JSON $view', ({ view, problem }) => {
    expect(() => read(view)).toThrow(new RegExp(`^"${problem!.slice(1).replaceAll('/', '.')}[."]`));
  });
});

describe('a link beside a first view', () => {
  const first = read({ attribute: 'distance', range: [-1, 1], cut: [0, 0, 1, 2], camera: [1, 2, 3, 0, 0, 0] });

  it('shows what it says nothing of as the model is seen first, part by part', () => {
    expect(readLink(overFirst('', first))).toEqual(first);
    expect(readLink(overFirst('wires=on', first))).toEqual({ wires: true, cut: [0, 0, 1, 2], camera: first.camera });
    expect(overFirst('up=z', {})).toBe('up=z');
  });

  it.each(['', 'colours=plain', 'up=z', 'measure=1,2,3', 'cut=1,0,0,0&object=', writeLink({ ...first, camera: undefined })])('comes back: %s', (link) => {
    const shown = readLink(overFirst(besideFirst(link, first), first));
    expect(writeLink({ ...shown, camera: undefined })).toBe(link);
  });

  it('says that there is nothing of a part', () => {
    expect(besideFirst('', first)).toBe('colours=vertex&cut=');
    const all = read({ level: 2, measure: [1, 2, 3], pick: [1, 2, 3], object: 'a', up: 'z' });
    const said = besideFirst('', all);
    expect(said).toBe('up=file&level=&measure=&pick=&between=');
    expect(partsOf(said)).toEqual(new Set(['standing', 'level', 'measure', 'pick', 'objects']));
    expect(readLink(overFirst(said, all))).toEqual({ up: 'file' });
    expect(partsOf('object=')).toEqual(new Set(['objects'])); // of that name
  });
});

describe('a link of bounded length', () => {
  const path = (points: number): number[] => Array.from({ length: 3 * points }, (_, i) => i / 7);

  it('holds all where it can', () => {
    const link = writeLink({ colours: 'height', measure: path(40) });
    expect(fittedLink(link)).toEqual({ link, leftOut: [] });
    expect(fittedLink('measure=&level=')).toEqual({ link: 'measure=&level=', leftOut: [] });
  });

  it('has the first points of a long path, and all of what is short', () => {
    const { link, leftOut } = fittedLink(writeLink({ wires: true, measure: path(400), pick: [1, 2, 3] }));
    expect([link.length <= 2000, leftOut]).toEqual([true, ['measure']]);
    const { measure, ...others } = readLink(link);
    expect(others).toEqual({ wires: true, pick: [1, 2, 3] });
    expect(measure!.length).toBeGreaterThan(100);
    expect(measure!.every((value, i) => Math.abs(value - i / 7) < 1e-9)).toBe(true);
  });

  it('has no more points than a view may', () => {
    const { link, leftOut } = fittedLink(writeLink({ measure: Array.from({ length: 300 }, (_, i) => i % 7) }));
    expect([readLink(link).measure?.length, leftOut]).toEqual([192, ['measure']]);
  });

  it('has the order of the table', () => { expect(orderedLink('story=2&up=z&nothing=1&hide=b&hide=a&wires=on')).toBe('wires=on&up=z&hide=b&hide=a&story=2'); });
});
