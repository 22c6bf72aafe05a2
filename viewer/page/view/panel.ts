// SPDX-License-Identifier: MIT
// The figures of a view.
import type { Manifest, Stats } from '../../src/index.js';
import { formatBytes, formatCount, formatDecimal, formatMilliseconds, formatPercent } from '../numbers.js';
import { element } from '../parts/element.js';
import type { ShownAppearance } from './presentation.js';
import type { ViewParts } from './view_parts.js';
import { words } from '../words/words.js';

const text = words.figures;

function levels({ tiles, coarsestLevel, finestLevel }: Stats): string {
  const count = formatCount(tiles);
  if (tiles === 0) return count;
  return coarsestLevel === finestLevel ? text.level(count, finestLevel) : text.levels(count, coarsestLevel, finestLevel);
}

function saved({ savedBytes, wholeViewBytes }: Stats): string {
  const part = wholeViewBytes > 0 ? ` (${formatPercent(savedBytes / wholeViewBytes)})` : '';
  return `${formatBytes(savedBytes)}${part}`;
}

/// Nothing of a mesh without pictures.
function pictures({ textures }: Manifest['source']): string {
  if (textures === null) return '';
  const count = words.counts.pictures(textures.images, formatCount(textures.images));
  return ` ${textures.missingImages > 0 ? text.missingPictures(count, formatCount(textures.missingImages)) : count}.`;
}

/// A rate that was never measured is no figure.
function rate({ framesPerSecond }: Stats, wanted: number): string {
  return text.of(formatDecimal(framesPerSecond > 0 ? framesPerSecond : NaN), formatCount(wanted));
}

function fetched({ fetchedBytes, fetchedFiles }: Stats): string {
  return `${formatBytes(fetchedBytes)}, ${words.counts.tiles(fetchedFiles, formatCount(fetchedFiles))}`;
}

function onTheWay({ pending, aborted, failed }: Stats): string {
  return text.onTheWay(formatCount(pending), formatCount(aborted), formatCount(failed));
}

/// The figure of each row, in the order shown.
const FIGURES: Readonly<Record<keyof typeof text.rows, (stats: Stats, wanted: number) => string>> = {
  rate,
  triangles: ({ triangles }) => formatCount(triangles),
  vertices: ({ vertices }) => formatCount(vertices),
  vertexBudget: ({ vertexBudget }) => text.atMost(formatCount(vertexBudget)),
  tiles: levels,
  error: ({ worstError }) => (Number.isFinite(worstError) ? `${formatDecimal(worstError)} ${words.settings.pixels}` : formatDecimal(NaN)),
  fetched,
  saved,
  hits: ({ hits }) => formatCount(hits),
  decoding: ({ decodeMilliseconds }) => formatMilliseconds(decodeMilliseconds),
  memory: ({ residentBytes, memoryBudget }) => text.of(formatBytes(residentBytes), formatBytes(memoryBudget)),
  peak: ({ peakBytes }) => formatBytes(peakBytes),
  resident: ({ residentTiles, evicted }) => text.dropped(formatCount(residentTiles), formatCount(evicted)),
  pending: onTheWay,
};

const ROWS = (Object.keys(FIGURES) as (keyof typeof FIGURES)[]).map((key) => ({ name: text.rows[key][0], tip: text.rows[key][1], figure: FIGURES[key] }));

export class Panel {
  readonly root: HTMLElement;
  private readonly source = element('p', { class: 'source' });
  private readonly terrain = element('p', { class: 'source' });
  private readonly values = ROWS.map(() => element('dd', {}));

  /// `isOpen`: whether somebody sees the figures.
  constructor({ context, choices: { presentation } }: ViewParts, isOpen: () => boolean) {
    const { view } = context;
    context.addEventListener('known', ({ manifest }) => { this.tellSource(manifest); });
    context.addEventListener('chosen', () => { this.tellTerrain(view.terrain === null ? null : presentation.shown); });
    context.addEventListener('report', ({ stats }) => { if (isOpen()) this.show(stats, view.settings.framesPerSecond); });
    const rows = ROWS.map(({ name, tip }, i) => element('div', { title: tip }, element('dt', {}, name), this.values[i]));
    this.root = element('div', {}, this.source, this.terrain, element('dl', { class: 'figures' }, ...rows));
  }

  /// Tells what the model was made from, and its licence.
  private tellSource({ source, licence }: Manifest): void {
    const [vertices, triangles] = (['vertices', 'triangles'] as const).map((what) => words.counts[what](source[what], formatCount(source[what])));
    this.source.textContent = `${text.source(source.fileName, vertices, triangles)}${pictures(source)}${licence === '' ? '' : ` ${licence}`}`;
  }

  /// Null: the model is no terrain.
  private tellTerrain(shown: ShownAppearance | null): void {
    this.terrain.hidden = shown === null;
    if (shown === null) return;
    const { terrain, byHeight, sunlit } = words.light;
    const { look, rig } = shown;
    this.terrain.textContent = [terrain, ...(look.colours === 'height' ? [byHeight] : []), ...(rig === 'sun' ? [sunlit(formatDecimal(look.relief))] : [])].join(' ');
  }

  /// `wanted`: frames per second.
  private show(stats: Stats, wanted: number): void {
    ROWS.forEach(({ figure }, i) => {
      const value = figure(stats, wanted);
      if (this.values[i].textContent !== value) this.values[i].textContent = value;
    });
  }
}
