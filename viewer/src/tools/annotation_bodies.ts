// SPDX-License-Identifier: MIT
// Reads what annotations say: texts, pictures and links, in the reader's language where there is a choice.
import type { JsonValue } from '../json_value.js';
import { idOf, isOfType } from './annotation_points.js';
import { MOST_TEXT } from './note.js';

/// Choices within resources within choices are followed so far.
const DEEPEST = 4;

/// The reader's languages, the one that is wanted most first: `de-AT`.
export type Languages = readonly string[];

/// A body, out of choices; `transforms`: of the resource that it is the source of.
export interface Body {
  readonly value: JsonValue;
  readonly transforms: readonly JsonValue[];
}

function primary(tag: string): string {
  return tag.toLowerCase().split('-')[0];
}

/// Returns the item in the first of the reader's languages that there is, else one in none, else the first.
export function chosenOf<Item>(items: readonly Item[], languagesOf: (item: Item) => readonly string[], wanted: Languages): Item | undefined {
  const inLanguage = (tag: string): Item | undefined => items.find((item) => languagesOf(item).some((each) => primary(each) === primary(tag)));
  for (const tag of wanted) {
    const found = inLanguage(tag);
    if (found !== undefined) return found;
  }
  return items.find((item) => languagesOf(item).length === 0) ?? inLanguage('none') ?? items[0];
}

function languagesOfBody(body: JsonValue): string[] {
  const [resource] = isOfType(body, 'SpecificResource') && body.has('source') ? body.at('source').oneOrMore() : [body];
  if (resource === undefined || !resource.isObject() || !resource.has('language')) return [];
  return resource.at('language').oneOrMore().flatMap((tag) => (tag.isText() ? [tag.text()] : []));
}

function listOf(value: JsonValue, key: string): JsonValue[] {
  return value.has(key) ? value.at(key).oneOrMore() : [];
}

function resolved({ value, transforms }: Body, languages: Languages, depth: number): Body[] {
  if (depth > DEEPEST) return [];
  if (isOfType(value, 'Choice')) {
    const chosen = chosenOf(listOf(value, 'items'), languagesOfBody, languages);
    return chosen === undefined ? [] : resolved({ value: chosen, transforms }, languages, depth + 1);
  }
  if (!isOfType(value, 'SpecificResource')) return [{ value, transforms }];
  const more = [...listOf(value, 'transform'), ...transforms];
  return listOf(value, 'source').flatMap((source) => resolved({ value: source, transforms: more }, languages, depth + 1));
}

export function bodiesOf(annotation: JsonValue, languages: Languages): Body[] {
  if (!annotation.isObject()) return [];
  const values = annotation.has('bodyValue') ? annotation.at('bodyValue').oneOrMore().filter((value) => !value.isText()) : []; // bodies that stand in its place
  return [...listOf(annotation, 'body'), ...values].flatMap((value) => resolved({ value, transforms: [] }, languages, 0));
}

export function shortened(text: string): string {
  return text.slice(0, MOST_TEXT);
}

/// Reads a text out of a map of languages.
export function labelOf(value: JsonValue, languages: Languages): string {
  if (!value.isObject() || !value.has('label')) return '';
  const label = value.at('label');
  if (label.isText()) return shortened(label.text());
  const [, texts] = chosenOf(label.entries(), ([language]) => [language], languages) ?? [];
  const text = texts?.oneOrMore()[0];
  return text?.isText() ? shortened(text.text()) : '';
}

/// Marks of a text in HTML are left out: the words are what counts.
function textOf(body: JsonValue): string {
  const text = body.at('value').text();
  return body.has('format') && body.at('format').isText('text/html') ? text.replace(/<[^<>]*>/g, ' ').replace(/\s+/g, ' ').trim() : text;
}

export interface Said {
  readonly text: string;
  readonly picture?: string;
  readonly link?: string;
}

export function saidBy(annotation: JsonValue, languages: Languages): Said {
  const bodies = bodiesOf(annotation, languages).map(({ value }) => value);
  const value = annotation.has('bodyValue') && annotation.at('bodyValue').isText() ? [annotation.at('bodyValue').text()] : [];
  const texts = [...value, ...bodies.filter((body) => isOfType(body, 'TextualBody')).map(textOf)];
  const picture = bodies.find((body) => isOfType(body, 'Image'));
  const link = bodies.find((body) => body.isObject() && body.at('purpose').isText('linking'));
  return { text: shortened(texts.join('\n')), ...(picture === undefined ? {} : { picture: idOf(picture) }), ...(link === undefined ? {} : { link: shortened(idOf(link)) }) };
}
