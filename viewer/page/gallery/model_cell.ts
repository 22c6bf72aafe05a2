// A model in the gallery: a link with its outline, its name and its size.
import { readOutline } from '../../src/hierarchy/outline.js';
import { formatAddress } from '../address.js';
import type { Model } from '../listing.js';
import { formatBytes, formatCount, formatRough } from '../numbers.js';
import { element } from '../parts/element.js';
import type { Turn } from './layout.js';
import { shapeOf, type Shape } from './shape.js';
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

async function fetchOutline(url: string): Promise<Shape> {
  const response = await fetch(`${url}/outline.glb`);
  if (!response.ok) throw new Error(`outline.glb: ${response.status} ${response.statusText}`.trim());
  return shapeOf(readOutline(new Uint8Array(await response.arrayBuffer())));
}

export class ModelCell {
  readonly root: HTMLLIElement;
  readonly stage: HTMLSpanElement;
  shape: Shape | null = null;
  private readonly turning: Turning;
  private asked = false;

  /// `changed`: there is something new to draw.
  constructor(readonly model: Model, private readonly changed: () => void) {
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

  /// Fetches the outline, once.
  load(): void {
    if (this.asked) return;
    this.asked = true;
    this.stage.classList.add('waiting');
    fetchOutline(this.model.url)
      .then((shape) => { this.show(shape); })
      .catch((error: unknown) => { this.tell(error instanceof Error ? error.message : String(error)); });
  }

  private show(shape: Shape): void {
    this.stage.classList.remove('waiting');
    this.shape = shape;
    if (shape.ends.length === 0) this.stage.append(element('span', { class: 'cell-note' }, 'one piece, without an outline'));
    this.changed();
  }

  private tell(problem: string): void {
    this.stage.classList.remove('waiting');
    this.stage.append(element('span', { class: 'cell-note cell-problem' }, `No outline: ${problem}`));
  }
}
