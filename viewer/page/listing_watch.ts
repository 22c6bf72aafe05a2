// Fetches the listing, and again and again while it tells of jobs.
import { ListingError, parseListing, type Listing } from './listing.js';

const PAUSE = 2000; // milliseconds

/// Its text, unchanged files from the browser's cache. Throws ListingError.
async function fetchText(url: string): Promise<string> {
  const response = await fetch(url, { cache: 'no-cache' }).catch(() => null);
  if (response === null) throw new ListingError(`${url} cannot be reached`);
  if (!response.ok) throw new ListingError(`${url}: ${`${response.status} ${response.statusText}`.trim()}`);
  return response.text();
}

export class ListingWatch {
  listing: Listing | null = null;
  private text: string | null = null;
  private timer = 0;
  private turn = 0;

  /// `changed`: the listing is another one. `failed`: with a message, while there is none at all.
  constructor(
    private readonly url: string,
    private readonly changed: (listing: Listing) => void,
    private readonly failed: (message: string) => void,
  ) {}

  start(): void {
    this.stop();
    void this.look(this.turn);
  }

  stop(): void {
    ++this.turn;
    window.clearTimeout(this.timer);
  }

  /// `turn`: that of the start which this look belongs to.
  private async look(turn: number): Promise<void> {
    try {
      if (this.listing === null || !document.hidden) this.take(await fetchText(this.url));
    } catch (error) {
      if (this.listing === null) this.failed(error instanceof ListingError ? error.message : String(error));
    }
    if (turn === this.turn && this.listing?.jobs) this.timer = window.setTimeout(() => void this.look(turn), PAUSE);
  }

  private take(text: string): void {
    if (text === this.text) return;
    const listing = parseListing(text, this.url);
    this.text = text;
    this.listing = listing;
    this.changed(listing);
  }
}
