// SPDX-License-Identifier: MIT
// The figures of two models, below those of the first one.
import type { PairStats } from '../../src/pair/index.js';
import { formatBytes, formatCount } from '../numbers.js';
import { element } from '../parts/element.js';
import { words } from '../words/words.js';

const text = words.pair.figures;

export class PairFigures {
  private readonly list = element('dl', { class: 'figures' });

  /// `names`: of the models.
  enter(root: ParentNode, names: readonly [string, string]): void {
    root.querySelector('.sheet-figures .sheet-body')?.append(element('h3', { class: 'help-title' }, text.title(...names)), this.list);
  }

  show({ views: [a, b], residentBytes, memoryBudget, peakBytes, vertices, vertexBudget }: PairStats): void {
    const both = (of: (stats: typeof a) => string): string => `${of(a)} + ${of(b)}`;
    const rows: readonly (readonly [string, string])[] = [
      [words.figures.rows.triangles[0], both(({ triangles }) => formatCount(triangles))],
      [words.figures.rows.vertices[0], `${both((stats) => formatCount(stats.vertices))} = ${formatCount(vertices)}`],
      [words.figures.rows.vertexBudget[0], words.figures.atMost(formatCount(vertexBudget))],
      [words.figures.rows.memory[0], words.figures.of(both((stats) => formatBytes(stats.residentBytes)), formatBytes(memoryBudget))],
      [words.figures.rows.peak[0], formatBytes(Math.max(peakBytes, residentBytes))],
    ];
    this.list.replaceChildren(...rows.map(([name, value]) => element('div', {}, element('dt', {}, name), element('dd', {}, value))));
  }
}
