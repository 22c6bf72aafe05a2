// A model in the gallery: a link with its outline, its name and its size.
import { formatAddress } from '../address.js';
import type { Model } from '../listing.js';
import { formatBytes, formatCount, formatRough } from '../numbers.js';
import { element } from '../parts/element.js';
import { words } from '../words/words.js';
import type { Turn } from './layout.js';
import { ModelSource, type Sizes } from './model_source.js';
import type { Shape } from './shape.js';
import { Turning } from './turning.js';

/// As people read them.
function roughSizes({ vertices, triangles, bytes }: Sizes): string[] {
  const parts = [];
  if (vertices !== null) parts.push(words.counts.vertices(vertices, formatRough(vertices)));
  if (triangles !== null) parts.push(words.counts.triangles(triangles, formatRough(triangles)));
  if (bytes !== null) parts.push(formatBytes(bytes));
  return parts;
}

function exactText({ name, source }: Model, { vertices, triangles, bytes }: Sizes): string {
  const parts = [source ?? name];
  if (vertices !== null) parts.push(words.counts.vertices(vertices, formatCount(vertices)));
  if (triangles !== null) parts.push(words.counts.triangles(triangles, formatCount(triangles)));
  if (bytes !== null) parts.push(words.counts.bytes(bytes, formatCount(bytes)));
  return parts.join('\n');
}

export class ModelCell {
  readonly root: HTMLLIElement;
  readonly stage: HTMLSpanElement;
  shape: Shape | null = null;
  private readonly turning: Turning;
  private readonly source: ModelSource;
  private readonly link: HTMLAnchorElement;
  private readonly sizes = element('span', { class: 'cell-size' });

  /// `changed`: there is something new to draw.
  constructor(readonly model: Model, private readonly changed: () => void) {
    this.source = new ModelSource(model.url);
    this.stage = element('span', { class: 'cell-stage' });
    this.link = element(
      'a',
      { class: 'cell', href: formatAddress({ path: model.path, pose: null }), draggable: 'false' },
      this.stage,
      element('span', { class: 'cell-name' }, model.name),
      this.sizes,
    );
    this.showSizes(model);
    this.root = element('li', {}, this.link);
    this.turning = new Turning(this.link, this.stage, changed);
  }

  private showSizes(sizes: Sizes): void {
    this.link.title = exactText(this.model, sizes);
    this.sizes.replaceChildren(...roughSizes(sizes).flatMap((text) => [element('span', {}, text), ' ']));
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

  /// Fetches the outline, and the sizes if the listing has none; again, once, if that failed and the cell comes into view again.
  load(): void {
    const asked = this.source.outline();
    if (asked === null) return;
    this.stage.replaceChildren();
    this.stage.classList.add('waiting');
    asked
      .then((shape) => {
        this.show(shape);
        return this.loadSizes();
      })
      .catch((error: unknown) => { this.tell(error instanceof Error ? error.message : String(error)); });
  }

  /// Without them the cell is as good.
  private async loadSizes(): Promise<void> {
    if (this.model.vertices !== null) return;
    const sizes = await this.source.sizes().catch(() => null);
    if (sizes !== null && !this.source.ended) this.showSizes(sizes);
  }

  /// It is gone from the gallery for good.
  close(): void {
    this.source.close();
    this.root.remove();
  }

  private show(shape: Shape): void {
    this.stage.classList.remove('waiting');
    this.shape = shape;
    if (shape.ends.length === 0) this.stage.append(element('span', { class: 'cell-note' }, words.gallery.onePiece));
    this.changed();
  }

  private tell(problem: string): void {
    if (this.source.ended) return;
    this.stage.classList.remove('waiting');
    this.stage.append(element('span', { class: 'cell-note cell-problem' }, words.gallery.noOutline(problem)));
  }
}
