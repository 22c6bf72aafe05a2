// SPDX-License-Identifier: MIT
// Fetches the listing, and again and again until there is one with models and while it tells of jobs.
import { HierarchyProblem } from '../src/hierarchy/problem.js';
import { linkPath } from './address.js';
import { fetchText } from './fetched.js';
import { partAddress, type Wish } from './gallery/wish.js';
import { ListingError, parseListing, type Listing, type Model } from './listing.js';
import { follow } from './signals.js';
import { words } from './words/words.js';

const ANY: Wish = { search: '', tag: '', order: 'folder' };
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
  private asked = ''; // where the text is from
  private timer = 0;
  private ending = new AbortController(); // of the last start

  /// `url`: where the addresses in the listing begin. `changed`: the listing is another one. `failed`: with a message, each time while there is none at all.
  constructor(
    private readonly url: string,
    private readonly changed: (listing: Listing) => void,
    private readonly failed: (message: string) => void,
    /// Returns the part of a listing that is for this visitor.
    private readonly visible: (listing: Listing) => Listing = (listing) => listing,
    /// Returns the address that asks for the part of it that is wanted now.
    private readonly address: () => string = () => url,
  ) {}

  /// What the listing says but for its models, known or asked for once.
  async once(signal: AbortSignal): Promise<Listing> {
    return this.listing ?? this.fetch(partAddress(this.url, ANY, { count: '1' }), signal);
  }

  /// What it says by now of the model of that path, as links have it, without watching it; null: nothing. Throws ListingError.
  async find(path: string, signal: AbortSignal): Promise<Model | null> {
    const known = this.listing ?? (await this.fetch(partAddress(this.url, ANY, { count: '1', path }), signal));
    const isThis = (model: Model): boolean => linkPath(model.path) === path;
    const more = known.part !== null && known === this.listing ? [partAddress(this.url, ANY, { count: '1', path })] : known.parts;
    let found = known.models.find(isThis);
    for (let i = 0; found === undefined && i < more.length; ++i) found = (await this.fetch(more[i], signal)).models.find(isThis);
    return found ?? null;
  }

  /// A part of the listing, from that address. Throws ListingError.
  async fetch(address: string, signal: AbortSignal): Promise<Listing> {
    return this.visible(parseListing(await fetchListing(address, signal), this.url));
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
      const address = this.address();
      const text = await fetchListing(address, ended);
      if (!ended.aborted) this.take(text, address);
      if (!ended.aborted && this.listing !== null) await this.readOn(this.listing, ended);
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

  /// Reads the parts that a listing goes on with, one behind the other. It is told of each time that there are twice as many models.
  private async readOn(listing: Listing, ended: AbortSignal): Promise<void> {
    if (listing.parts.length === 0) return;
    const models = [...listing.models];
    let told = models.length;
    for (const [i, part] of listing.parts.entries()) {
      models.push(...(await this.fetch(part, ended)).models);
      if (ended.aborted) return;
      if (models.length < 2 * told && i + 1 < listing.parts.length) continue;
      told = models.length;
      this.listing = { ...listing, models: [...models], parts: listing.parts.slice(i + 1) };
      this.changed(this.listing);
    }
  }

  private take(text: string, address: string): void {
    if (text === this.text && address === this.asked) return;
    const listing = this.visible(parseListing(text, this.url));
    [this.text, this.asked] = [text, address];
    this.listing = listing;
    this.changed(listing);
  }
}
