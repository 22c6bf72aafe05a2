// SPDX-License-Identifier: MIT
// Views in links: `NAME=VALUE` with & between, the camera without a name. Whatever is read, what comes out is sound.
import { isOtherwise, keysOf, MOST_MEASURED, rowOf, VIEW_KEYS, VIEW_PARTS, type View, type ViewKey, type ViewPart } from './view_table.js';

/// Longer links are cut by what people paste them into.
export const LONGEST_LINK = 2000;

/// What a link tells of a view, as it stands there: a text for each time that a key does.
interface Said {
  readonly key: ViewKey;
  readonly text: string;
}

function nameOf(key: ViewKey): string {
  return key === 'camera' ? '' : `${key}=`;
}

/// All texts that a link has of each key; the camera's is bare.
function textsOf(link: string): ReadonlyMap<string, string[]> {
  const texts = new Map<string, string[]>();
  for (const [name, text] of new URLSearchParams(link)) {
    const isBare = text === '' && name.includes(',');
    const [key, value] = isBare ? ['camera', name] : [name, text];
    texts.set(key, [...(texts.get(key) ?? []), value]);
  }
  return texts;
}

function checked(view: View): View {
  return view.cut !== undefined && view.box !== undefined ? { ...view, box: undefined } : view;
}

/// Reads what a link says of a view, its model left out; what cannot be read is as if it were not there.
export function readLink(link: string): View {
  const texts = textsOf(link);
  const entries = VIEW_KEYS.map((key) => [key, rowOf(key).kind.parse(texts.get(key) ?? [])] as const);
  return checked(Object.fromEntries(entries.filter(([, value]) => value !== null)));
}

/// Parts that a link says something of, be it that there is nothing of them.
export function partsOf(link: string): ReadonlySet<ViewPart> {
  const texts = textsOf(link);
  const says = (key: ViewKey): boolean => rowOf(key).kind.parse(texts.get(key) ?? []) !== null || (isMark(key) && texts.get(key)?.[0] === '');
  return new Set(VIEW_KEYS.filter(says).map((key) => rowOf(key).part));
}

/// The texts of a link that tell of these parts, as they stand there, with & between.
export function linkOf(link: string, ...parts: readonly ViewPart[]): string {
  const names = keysOf(...parts).map(nameOf);
  return link.split('&').filter((text) => names.some((name) => (name === '' ? !text.includes('=') && text !== '' : text.startsWith(name)))).join('&');
}

function saidOf(view: View): Said[] {
  return VIEW_KEYS.filter((key) => !isOtherwise(key, view[key])).flatMap((key) => rowOf(key).kind.format(view[key]).map((text) => ({ key, text: `${nameOf(key)}${text}` })));
}

/// Writes what readLink() reads again: all that is not as without a choice.
export function writeLink(view: View): string {
  return saidOf(view).map(({ text }) => text).join('&');
}

/// The key that says of a part that there is nothing of it: by its default, or by no text where that is no value.
function markOf(part: ViewPart): ViewKey {
  return keysOf(part).find((key) => rowOf(key).otherwise !== null || rowOf(key).kind.parse(['']) === null)!;
}

function isMark(key: ViewKey): boolean {
  return markOf(rowOf(key).part) === key && rowOf(key).otherwise === null;
}

/// Says of a part that it is as without a choice.
function saidNothing(part: ViewPart): string {
  const key = markOf(part);
  const { kind, otherwise } = rowOf(key);
  return `${nameOf(key)}${otherwise === null ? '' : kind.format(otherwise)[0]}`;
}

/// What is seen where a model is first seen as `first` and a link is followed: the link's parts, and those of `first` that it says nothing of.
export function overFirst(link: string, first: View): string {
  const said = partsOf(link);
  const others = VIEW_PARTS.filter((part) => !said.has(part)).map((part) => linkOf(writeLink(first), part));
  return [link, ...others].filter((text) => text !== '').join('&');
}

/// What a link has to tell so that overFirst() comes to `link`: also that there is nothing of what `first` has something of.
export function besideFirst(link: string, first: View): string {
  const said = partsOf(link);
  const nothings = [...partsOf(writeLink(first))].filter((part) => part !== 'camera' && !said.has(part)).map(saidNothing);
  return [link, ...nothings].filter((text) => text !== '').join('&');
}

/// The texts of a link in the order of the table.
export function orderedLink(link: string): string {
  const texts = link.split('&');
  return VIEW_KEYS.flatMap((key) => texts.filter((text) => nameOf(key) !== '' && text.startsWith(nameOf(key)))).join('&');
}

export interface FittedLink {
  readonly link: string;
  /// Parts that the link does not tell all of.
  readonly leftOut: readonly ViewPart[];
}

/// So many of a path's first points as fit.
function shortened(text: string, room: number): string | null {
  const numbers = text.slice(nameOf('measure').length).split(',');
  if (text === nameOf('measure')) return text;
  for (let count = Math.min(numbers.length - (numbers.length % 3), 3 * MOST_MEASURED); count > 0; count -= 3) {
    const part = `${nameOf('measure')}${numbers.slice(0, count).join(',')}`;
    if (part.length < room) return part;
  }
  return null;
}

/// What a link of at most so many characters tells: the shortest texts first, so that a path of many points, or a hundred names of objects, leaves
/// out itself and nothing else.
export function fittedLink(link: string, longest = LONGEST_LINK): FittedLink {
  const texts = link.split('&').filter((text) => text !== '');
  const fitting = new Map<number, string>();
  const leftOut = new Set<ViewPart>();
  let room = longest;
  const order = texts.map((_, i) => i).sort((a, b) => texts[a].length - texts[b].length || a - b);
  for (const i of order) {
    const key = VIEW_KEYS.find((each) => nameOf(each) !== '' && texts[i].startsWith(nameOf(each))) ?? 'camera';
    const fits = key === 'measure' ? shortened(texts[i], room) : texts[i].length < room ? texts[i] : null;
    if (fits !== texts[i]) leftOut.add(rowOf(key).part);
    if (fits === null) continue;
    fitting.set(i, fits);
    room -= fits.length + 1;
  }
  return { link: texts.flatMap((_, i) => fitting.get(i) ?? []).join('&'), leftOut: [...leftOut] };
}
