// SPDX-License-Identifier: MIT
// The gallery's part for a map. Its code comes when the map is first wanted.
import type { ModelSpot } from '../listing.js';
import { element } from '../parts/element.js';
import type { ModelsAt, PlacesMap } from './places_map.js';

export class MapPlace {
  readonly root = element('div', { hidden: true });
  private map: Promise<PlacesMap> | null = null;
  private asking = new AbortController();

  /// `modelsAt`: of the numbers that spots have.
  constructor(private readonly modelsAt: ModelsAt) {}

  get shown(): boolean {
    return !this.root.hidden;
  }

  /// Resolves when the spots are there, or others are wanted.
  async show(spots: (signal: AbortSignal) => Promise<readonly ModelSpot[]>): Promise<void> {
    this.root.hidden = false;
    this.asking.abort();
    this.asking = new AbortController();
    const { signal } = this.asking;
    this.map ??= this.load();
    const [map, found] = await Promise.all([this.map, spots(signal)]).catch(() => [null, []] as const);
    if (map === null) this.map = null; // code that did not come is asked for again
    else if (!signal.aborted) map.show(found);
  }

  hide(): void {
    this.asking.abort();
    this.root.hidden = true;
  }

  private async load(): Promise<PlacesMap> {
    const { PlacesMap } = await import('./places_map.js');
    const map = new PlacesMap(this.modelsAt);
    this.root.append(map.root);
    return map;
  }
}
