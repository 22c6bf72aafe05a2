// SPDX-License-Identifier: MIT
// The models that a server finds, of which only those near the window are fetched.
//
// Idea: the server tells how many there are, and how they are grouped; each has a slot from the beginning, so that the page is as high as it
//   will be. A slot that comes near the window asks for the part that it lies in.
// Invariant: all parts are of one state of the listing: one of another state is not taken, and `outdated` is called.
import type { Listing, ListingPart, Model } from '../listing.js';
import { PART } from './wish.js';

/// Fetches the part that begins at a model; rejects where it cannot.
export type FetchPart = (first: number, state: string, signal: AbortSignal) => Promise<Listing>;

export class PagedModels {
  readonly slots: (Model | null)[];
  private readonly asked = new Set<number>(); // parts
  private readonly ending = new AbortController();

  /// `came`: slots have been filled.
  constructor(
    readonly part: ListingPart,
    models: readonly Model[],
    private readonly fetchPart: FetchPart,
    private readonly came: () => void,
    private readonly outdated: () => void,
  ) {
    this.slots = new Array<Model | null>(part.found).fill(null);
    this.fill(part.first, models);
    this.asked.add(Math.floor(part.first / PART));
  }

  /// Asks for the part that a model lies in, once.
  need(index: number): void {
    void this.load(Math.floor(index / PART));
  }

  /// Resolves with models, by their numbers; those that do not come are left out.
  async at(indices: readonly number[]): Promise<Model[]> {
    const parts = new Set(indices.filter((index) => this.slots[index] === null).map((index) => Math.floor(index / PART)));
    await Promise.all([...parts].map((part) => this.load(part)));
    return indices.map((index) => this.slots[index] ?? null).filter((model) => model !== null);
  }

  close(): void {
    this.ending.abort();
  }

  private async load(part: number): Promise<void> {
    if (this.asked.has(part)) return;
    this.asked.add(part);
    const { signal } = this.ending;
    try {
      const listing = await this.fetchPart(part * PART, this.part.state, signal);
      if (signal.aborted) return;
      if (listing.part?.state !== this.part.state) {
        this.outdated();
        return;
      }
      this.fill(listing.part.first, listing.models);
      this.came();
    } catch {
      this.asked.delete(part); // a slot that comes near again asks again
    }
  }

  private fill(first: number, models: readonly Model[]): void {
    models.forEach((model, i) => { if (first + i < this.slots.length) this.slots[first + i] = model; });
  }
}
