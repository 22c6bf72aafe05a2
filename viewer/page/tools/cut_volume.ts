// SPDX-License-Identifier: MIT
// The volume that a cut leaves: of the triangles that are shown, or of the original's, partition by partition.
import type { CutPlane } from '../../src/tools/planes.js';
import { originalVolume } from '../../src/tools/original_volume.js';
import { recordedBound, shownBound } from '../../src/tools/shown_bound.js';
import { shownSurface } from '../../src/tools/shown_triangles.js';
import { volumeOf, type Volume } from '../../src/tools/volume.js';
import { element } from '../parts/element.js';
import { FigureList, line, textButton } from './figures.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

/// What is kept of a model, in the tiles' coordinates.
export interface Kept {
  /// Volumes are measured above or within these.
  readonly planes: readonly CutPlane[];
  /// A level plane cuts a terrain: there is a volume between the two.
  readonly isLevel: boolean;
}

export class CutVolume {
  private readonly list = new FigureList();
  private readonly original = textButton(words.clip.original, () => void this.measureOriginal());
  /// The parts of a tool's card.
  readonly parts: readonly HTMLElement[] = [this.list.root, this.original];
  readonly note = element('p', { class: 'tool-note', 'aria-live': 'polite' });
  /// The volume was measured of this.
  private measured = '';
  /// The original's volume, with the planes and objects that it was measured for.
  private exact: { of: string; volume: Volume } | null = null;
  private measuring = new AbortController();

  constructor(private readonly shop: Workshop, private readonly kept: () => Kept) {}

  /// Once the view rests: as finer tiles come, the volume is told anew.
  drawn(): void {
    const { view } = this.shop.bench;
    if (!this.list.root.isConnected || !view.stats().settled) return;
    const tiles = view.surface.map(({ node: { level, index }, triangles }) => `${level}/${index}:${triangles}`);
    const { shownKey } = this;
    const key = [shownKey, this.shop.scale.sign, this.exact?.of, ...tiles].join();
    if (key === this.measured) return;
    this.measured = key;
    if (this.exact?.of !== shownKey && this.note.textContent === words.clip.isOriginal) this.note.textContent = '';
    const volume = this.exact?.of === shownKey ? this.exact.volume : this.shownVolume();
    this.original.hidden = volume === null || volume.bound === 0 || volume === this.exact?.volume;
    this.tell(volume);
  }

  /// Ends what is being measured.
  stop(): void {
    this.measuring.abort();
    this.note.textContent = '';
  }

  private tell(volume: Volume | null): void {
    const { scale, bench: { view } } = this.shop;
    const name = view.closed ? words.clip.volume : words.clip.between;
    this.list.show(volume === null ? [] : [line(name, scale.formatVolumeWithin(Math.abs(volume.volume), volume.bound), Math.abs(volume.volume) * scale.factor ** 3)]);
  }

  /// Volumes are of these planes and objects.
  private get shownKey(): string {
    return JSON.stringify([this.kept(), this.shop.bench.view.omissionKey]);
  }

  private async measureOriginal(): Promise<void> {
    const { source, omits } = this.shop.bench.view;
    const of = this.shownKey;
    if (source === null) return;
    this.measuring.abort();
    this.measuring = new AbortController();
    const { signal } = this.measuring;
    const progress = (done: number, all: number): void => {
      if (of === this.shownKey) this.note.textContent = words.clip.measuring(String(done), String(all));
      else this.stop(); // a sum over two choices of objects is none
    };
    try {
      const volume = await originalVolume(source, this.kept().planes, { signal, omits, progress });
      signal.throwIfAborted();
      this.exact = { of, volume };
      this.note.textContent = words.clip.isOriginal;
      this.shop.bench.redraw();
    } catch (problem) {
      if (!signal.aborted) this.note.textContent = words.clip.noOriginal(problem instanceof Error ? problem.message : String(problem));
    }
  }

  /// Measures what is kept of a closed model, or what lies between a terrain and a level plane.
  private shownVolume(): Volume | null {
    const { view } = this.shop.bench;
    const { source } = view;
    const { planes, isLevel } = this.kept();
    if (source === null || !(view.closed || isLevel)) return null;
    const surface = shownSurface(view);
    const bounds = new Map(surface.map(({ node }) => [node, shownBound(node, surface, (other) => recordedBound(source, other))]));
    return volumeOf(surface, planes, (node) => bounds.get(node) ?? Infinity);
  }
}
