// The figures of a view.
import type { Manifest, Stats } from '../../src/index.js';
import { formatBytes, formatCount, formatDecimal, formatMilliseconds } from '../numbers.js';
import { element } from '../parts/element.js';

function levels({ tiles, coarsestLevel, finestLevel }: Stats): string {
  if (tiles === 0) return '0';
  const range = coarsestLevel === finestLevel ? `level ${finestLevel}` : `levels ${coarsestLevel} to ${finestLevel}`;
  return `${formatCount(tiles)}, ${range}`;
}

function saved({ savedBytes, wholeViewBytes }: Stats): string {
  const part = wholeViewBytes > 0 ? ` (${Math.round((100 * savedBytes) / wholeViewBytes)} %)` : '';
  return `${formatBytes(savedBytes)}${part}`;
}

/// Nothing of a mesh without pictures.
function pictures({ textures }: Manifest['source']): string {
  if (textures === null) return '';
  const missing = textures.missingImages > 0 ? `, ${formatCount(textures.missingImages)} of them missing` : '';
  return ` ${formatCount(textures.images)} ${textures.images === 1 ? 'picture' : 'pictures'}${missing}.`;
}

/// What was never measured is no figure.
function rate({ framesPerSecond }: Stats, wanted: number): string {
  return framesPerSecond > 0 ? `${formatDecimal(framesPerSecond)} of ${wanted}` : `– of ${wanted}`;
}

function fetched({ fetchedBytes, fetchedFiles }: Stats): string {
  return `${formatBytes(fetchedBytes)}, ${formatCount(fetchedFiles)} ${fetchedFiles === 1 ? 'tile' : 'tiles'}`;
}

interface Row {
  name: string;
  tip: string;
  text: (stats: Stats, wanted: number) => string;
}

const ROWS: readonly Row[] = [
  { name: 'Frames per second', tip: 'while the camera moves, and the goal', text: rate },
  { name: 'Triangles', tip: 'in view', text: ({ triangles }) => formatCount(triangles) },
  { name: 'Vertices', tip: 'in view', text: ({ vertices }) => formatCount(vertices) },
  { name: 'Vertices in motion', tip: 'the most that the frame rate allows', text: ({ vertexBudget }) => `at most ${formatCount(vertexBudget)}` },
  { name: 'Tiles', tip: 'in view', text: levels },
  { name: 'Largest error', tip: 'on screen, of what is shown', text: ({ worstError }) => (Number.isFinite(worstError) ? `${formatDecimal(worstError)} px` : '–') },
  { name: 'Fetched', tip: 'bytes of tiles, and their number', text: fetched },
  { name: 'Saved', tip: 'against sending each view whole', text: saved },
  { name: 'Hits', tip: 'tiles of views that were there already', text: ({ hits }) => formatCount(hits) },
  { name: 'Decoding', tip: 'of all tiles together', text: ({ decodeMilliseconds }) => formatMilliseconds(decodeMilliseconds) },
  { name: 'Memory', tip: 'of tiles, and the budget', text: ({ residentBytes, memoryBudget }) => `${formatBytes(residentBytes)} of ${formatBytes(memoryBudget)}` },
  { name: 'Most memory', tip: 'of tiles so far', text: ({ peakBytes }) => formatBytes(peakBytes) },
  { name: 'In memory', tip: 'tiles, and those that made room for others', text: ({ residentTiles, evicted }) => `${formatCount(residentTiles)}, ${formatCount(evicted)} dropped` },
  { name: 'On their way', tip: 'files asked for; given up because the view went elsewhere; failed', text: ({ pending, aborted, failed }) => `${pending}, ${aborted} given up, ${failed} failed` },
];

export class Panel {
  readonly root: HTMLElement;
  private readonly source = element('p', { class: 'source' });
  private readonly values = ROWS.map(() => element('dd', {}));

  constructor() {
    const rows = ROWS.map(({ name, tip }, i) => element('div', { title: tip }, element('dt', {}, name), this.values[i]));
    this.root = element('div', {}, this.source, element('dl', { class: 'figures' }, ...rows));
  }

  /// What the model was made from, and its licence.
  tellSource({ source, licence }: Manifest): void {
    const counts = `${formatCount(source.vertices)} vertices and ${formatCount(source.triangles)} triangles`;
    this.source.textContent = `${source.fileName}: ${counts}.${pictures(source)}${licence === '' ? '' : ` ${licence}`}`;
  }

  /// `wanted`: frames per second.
  show(stats: Stats, wanted: number): void {
    ROWS.forEach(({ text }, i) => {
      const value = text(stats, wanted);
      if (this.values[i].textContent !== value) this.values[i].textContent = value;
    });
  }
}
