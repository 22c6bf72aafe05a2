// SPDX-License-Identifier: MIT
// Fetches the listing, and again and again until there is one with models and while it tells of jobs.
import { HierarchyProblem } from '../src/hierarchy/problem.js';
import { fetchText } from './fetched.js';
import { ListingError, parseListing, type Listing } from './listing.js';
import { follow } from './signals.js';
import { words } from './words/words.js';

const PAUSE = 2000; // milliseconds
const PATIENCE = 30_000; // milliseconds, with a host that says nothing or little
const MOST_BYTES = 2 ** 24; // room for the 10,000 entries that are read, of 1600 bytes each

/// Fetches the listing's text. Throws ListingError.
async function fetchListing(url: string, ended: AbortSignal): Promise<string> {
  const ending = new AbortController();
  const timer = window.setTimeout(() => { ending.abort(); }, PATIENCE);
  follow(ending, ended);
  try {
    return await fetchText(url, MOST_BYTES, ending.signal, (what) => { throw new ListingError(what); });
  } catch (problem) {
    if (problem instanceof ListingError) throw problem;
    throw new ListingError(problem instanceof HierarchyProblem ? problem.message : words.listing.unreachable(url));
  } finally {
    window.clearTimeout(timer);
    ending.abort(); // what is left of it is not read
  }
}

export class ListingWatch {
  listing: Listing | null = null;
  private text: string | null = null;
  private timer = 0;
  private ending = new AbortController(); // of the last start

  /// `changed`: the listing is another one. `failed`: with a message, each time while there is none at all.
  constructor(
    private readonly url: string,
    private readonly changed: (listing: Listing) => void,
    private readonly failed: (message: string) => void,
    /// Returns the part of a listing that is for this visitor.
    private readonly visible: (listing: Listing) => Listing = (listing) => listing,
  ) {}

  /// As it is now, without watching it. Throws ListingError.
  async once(signal: AbortSignal): Promise<Listing> {
    return this.listing ?? this.visible(parseListing(await fetchListing(this.url, signal), this.url));
  }

  start(): void {
    this.stop();
    this.ending = new AbortController();
    void this.look(this.ending.signal);
  }

  stop(): void {
    this.ending.abort();
    window.clearTimeout(this.timer);
  }

  /// `ended`: the start which this look belongs to.
  private async look(ended: AbortSignal): Promise<void> {
    try {
      const text = await fetchListing(this.url, ended);
      if (!ended.aborted) this.take(text);
    } catch (error) {
      if (!ended.aborted && this.listing === null) this.failed(error instanceof ListingError ? error.message : String(error));
    }
    if (!ended.aborted) this.wait(ended);
  }

  /// For the next look, if there is to be one.
  private wait(ended: AbortSignal): void {
    if (this.listing !== null && this.listing.jobs === null && this.listing.models.length > 0) return;
    this.timer = window.setTimeout(() => {
      if (document.hidden) this.wait(ended);
      else void this.look(ended);
    }, PAUSE);
  }

  private take(text: string): void {
    if (text === this.text) return;
    const listing = this.visible(parseListing(text, this.url));
    this.text = text;
    this.listing = listing;
    this.changed(listing);
  }
}
