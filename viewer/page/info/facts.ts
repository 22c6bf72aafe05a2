// SPDX-License-Identifier: MIT
// Tells people what is known of a model: of what is not known there is no line.
import type { Manifest } from '../../src/index.js';
import { LengthScale, unitOfModel } from '../../src/tools/units.js';
import type { Model } from '../listing.js';
import { formatBytes, formatCount, formatDate, writeDecimal } from '../numbers.js';
import { element } from '../parts/element.js';
import type { PageContext } from '../view/page_context.js';
import { words } from '../words/words.js';

export type Fact = readonly [name: string, text: string];

/// Along the axes of the input, in the model's unit if that is known.
function extentOf(manifest: Manifest): string {
  const { min, max } = manifest.source;
  const unit = unitOfModel(manifest) ?? 'unit';
  return new LengthScale(unit, unit, '', writeDecimal).formatSides(max.map((value, axis) => value - min[axis]));
}

function colours({ source: { textures, hasColours } }: Manifest): string | null {
  if (textures === null) return hasColours ? words.info.vertexColours : null;
  const count = words.counts.pictures(textures.images, formatCount(textures.images));
  return textures.missingImages > 0 ? words.figures.missingPictures(count, formatCount(textures.missingImages)) : count;
}

export function factsOf(model: Model, manifest: Manifest): Fact[] {
  const { source, licence, totalBytes } = manifest;
  const names = words.info.rows;
  const facts: (readonly [string, string | null])[] = [
    [names.source, source.fileName],
    [names.licence, licence.trim()],
    [names.triangles, formatCount(source.triangles)],
    [names.vertices, formatCount(source.vertices)],
    [names.colours, colours(manifest)],
    [names.extent, extentOf(manifest)],
    [names.sourceBytes, formatBytes(source.fileBytes)],
    [names.bytes, formatBytes(totalBytes)],
    [names.modified, model.modified === null ? null : formatDate(model.modified)],
    [names.warnings, model.warnings?.join('\n') ?? null],
  ];
  return facts.flatMap(([name, text]) => (text === null || text === '' ? [] : [[name, text] as const]));
}

/// In a sentence or two, for those who do not see the model.
export function summaryOf(model: Model, manifest: Manifest): string {
  const { triangles } = manifest.source;
  return words.info.summary(model.name, words.counts.triangles(triangles, formatCount(triangles)), extentOf(manifest));
}

export class InfoSheet {
  readonly root = element('dl', { class: 'figures info' });
  private shown: Manifest | null = null;

  constructor(context: PageContext) {
    context.addEventListener('known', ({ manifest }) => { this.show(context.model, manifest); });
  }

  private show(model: Model, manifest: Manifest): void {
    if (manifest === this.shown) return;
    this.shown = manifest;
    const rows = factsOf(model, manifest).map(([name, text]) => element('div', {}, element('dt', {}, name), element('dd', {}, text)));
    this.root.replaceChildren(...rows);
  }
}
