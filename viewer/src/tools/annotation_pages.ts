// SPDX-License-Identifier: MIT
// The annotations of a document: of a page of them, or of all pages of a scene or a whole manifest of IIIF.
import type { JsonValue } from '../json_value.js';
import { isOfType } from './annotation_points.js';

export const DOCUMENTS = ['AnnotationPage', 'Scene', 'Manifest'] as const;

export interface Found {
  readonly items: JsonValue[];
  /// Pages that are named, but are not in the document.
  pagesElsewhere: number;
}

function listOf(value: JsonValue, key: string): JsonValue[] {
  return value.isObject() && value.has(key) ? value.at(key).items() : [];
}

/// All of what there is a choice of.
function itemsOf(page: JsonValue): JsonValue[] {
  return listOf(page, 'items').flatMap((item) => (isOfType(item, 'Choice') ? listOf(item, 'items') : [item]));
}

function takePage(page: JsonValue, found: Found): void {
  if (!isOfType(page, 'AnnotationPage')) return;
  if (page.has('items')) for (const item of itemsOf(page)) found.items.push(item);
  else ++found.pagesElsewhere;
}

/// Takes what is painted into a scene, or something else with pages, and what is said of it.
function takePages(container: JsonValue, found: Found): void {
  for (const page of [...listOf(container, 'items'), ...listOf(container, 'annotations')]) takePage(page, found);
}

/// Those of a scene that another document has within it; annotations may be in it without a page.
export function annotationsWithin(scene: JsonValue): JsonValue[] {
  return listOf(scene, 'items').flatMap((item) => (isOfType(item, 'AnnotationPage') ? itemsOf(item) : [item]));
}

/// `root`: one of DOCUMENTS. Refuses one without a list of items.
export function annotationsIn(root: JsonValue): Found {
  const found: Found = { items: [], pagesElsewhere: 0 };
  const items = root.at('items').items();
  if (root.at('type').isText('AnnotationPage')) return { ...found, items: itemsOf(root) };
  takePages(root, found);
  if (root.at('type').isText('Manifest')) for (const scene of items) takePages(scene, found);
  return found;
}
