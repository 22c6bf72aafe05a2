// A model in the gallery: a link with its outline, its name and its size.
import { formatAddress } from '../address.js';
import type { Model } from '../listing.js';
import { formatBytes, formatCount, formatRough } from '../numbers.js';
import { element } from '../parts/element.js';
import type { Turn } from './layout.js';
import { OutlineSource } from './outline_source.js';
import type { Shape } from './shape.js';
import { Turning } from './turning.js';

/// What is known of it, as people read it.
function sizes({ vertices, triangles, bytes }: Model): string[] {
  const parts = [];
  if (vertices !== null) parts.push(`${formatRough(vertices)} vertices`);
  if (triangles !== null) parts.push(`${formatRough(triangles)} triangles`);
  if (bytes !== null) parts.push(formatBytes(bytes));
  return parts;
}

function exactText({ name, vertices, triangles, bytes, source }: Model): string {
  const parts = [source ?? name];
  if (vertices !== null) parts.push(`${formatCount(vertices)} vertices`);
  if (triangles !== null) parts.push(`${formatCount(triangles)} triangles`);
  if (bytes !== null) parts.push(`${formatCount(bytes)} bytes`);
  return parts.join('\n');
}

export class ModelCell {
  readonly root: HTMLLIElement;
  readonly stage: HTMLSpanElement;
  shape: Shape | null = null;
  private readonly turning: Turning;
  private readonly outline: OutlineSource;

  /// `changed`: there is something new to draw.
  constructor(readonly model: Model, private readonly changed: () => void) {
    this.outline = new OutlineSource(model.url);
    this.stage = element('span', { class: 'cell-stage' });
    const link = element(
      'a',
      { class: 'cell', href: formatAddress({ path: model.path, pose: null }), title: exactText(model), draggable: 'false' },
      this.stage,
      element('span', { class: 'cell-name' }, model.name),
      element('span', { class: 'cell-size' }, ...sizes(model).flatMap((text) => [element('span', {}, text), ' '])),
    );
    this.root = element('li', {}, link);
    this.turning = new Turning(link, this.stage, changed);
  }

  get turn(): Turn {
    return this.turning.turn;
  }

  get lively(): boolean {
    return this.turning.lively;
  }

  /// Turns it on by itself, unless it is held.
  advance(angle: number): void {
    this.turning.advance(angle);
  }

  /// Fetches the outline; again, once, if that failed and the cell comes into view again.
  load(): void {
    const asked = this.outline.ask();
    if (asked === null) return;
    this.stage.replaceChildren();
    this.stage.classList.add('waiting');
    asked
      .then((shape) => { this.show(shape); })
      .catch((error: unknown) => { this.tell(error instanceof Error ? error.message : String(error)); });
  }

  /// It is gone from the gallery for good.
  close(): void {
    this.outline.close();
    this.root.remove();
  }

  private show(shape: Shape): void {
    this.stage.classList.remove('waiting');
    this.shape = shape;
    if (shape.ends.length === 0) this.stage.append(element('span', { class: 'cell-note' }, 'one piece, without an outline'));
    this.changed();
  }

  private tell(problem: string): void {
    if (this.outline.ended) return;
    this.stage.classList.remove('waiting');
    this.stage.append(element('span', { class: 'cell-note cell-problem' }, `No outline: ${problem}`));
  }
}
