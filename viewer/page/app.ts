// SPDX-License-Identifier: MIT
// Shows what the address says: the gallery, or a model.
import { formatAddress, linkPath, NOWHERE, parseAddress, type Spot } from './address.js';
import { takeBooted } from './booted.js';
import { EarlyStart } from './early_start.js';
import type { Gallery, GallerySource } from './gallery/gallery.js';
import { partAddress } from './gallery/wish.js';
import type { Turn } from './gallery/layout.js';
import { ListingWatch } from './listing_watch.js';
import { modelOfPath, withoutWarnings, type Listing, type Model } from './listing.js';
import { readable } from './path_name.js';
import { ModelEntry } from './model_entry.js';
import { Page } from './page.js';
import type { Poster } from './poster.js';
import { readQuery, shortened, type Query } from './query.js';
import { leavesEntries, showAddress, visit, watchLinks } from './visits.js';
import { mayAsk, maySend } from './upload/permission.js';
import { UploadPlace } from './upload/upload_place.js';
import { language, words } from './words/words.js';
import type { ModelView } from './view/model_view.js';

/// Says what to do about a listing without a model; `url`: its own.
function emptyText({ folder, inbox }: Listing, url: string): string {
  const { gallery } = words;
  if (folder === null) return `${gallery.emptyListing(url)} ${gallery.howToList}`;
  return inbox === null ? gallery.emptyFolder(folder) : gallery.emptyFolderWithInbox(folder, inbox);
}

/// A browser's word for code that did not come says nothing to people.
function messageOf(error: unknown): string {
  if (error instanceof TypeError) return words.problems.noCode;
  return error instanceof Error ? error.message : String(error);
}

/// The view's code: once, when it is likely to be wanted.
function loadView(): Promise<typeof import('./view/model_view.js')> {
  return import('./view/model_view.js');
}

/// The focus is moved by keys, or not: some is only for those who do so.
function watchInput(): void {
  const note = (input: 'keys' | 'pointer'): void => { document.documentElement.dataset.input = input; };
  window.addEventListener('keydown', ({ key }) => { if (key === 'Tab') note('keys'); }, { capture: true });
  window.addEventListener('pointerdown', () => { note('pointer'); }, { capture: true });
}

export class App {
  view: ModelView | null = null;
  private readonly page = new Page();
  private readonly query: Query;
  private readonly watch: ListingWatch;
  private gallery: Gallery | null = null;
  private uploads: UploadPlace | null = null;
  private entry: ModelEntry | null = null; // of the model that is shown: what was loaded for an earlier one is of no use
  private poster: Poster | null = null;
  private said = '';
  private left: string | null = null;
  private asksToken = false;

  /// `embedded`: what the page shows instead of what its address says; null: nothing.
  constructor(private readonly root: HTMLElement, embedded: Model | null) {
    this.query = readQuery(location.search, document.baseURI, embedded);
    this.watch = new ListingWatch(
      this.query.listing,
      (listing) => { this.listed(listing); },
      (message) => { this.say(`${words.gallery.nothingToShow(message)} ${words.gallery.howToList}`); },
      (listing) => (maySend(listing.upload, this.query.listing) ? listing : withoutWarnings(listing)),
      () => partAddress(this.query.listing, this.gallery?.wish ?? { search: '', tag: '', order: this.page.preferences.order }),
    );
    document.documentElement.lang = language;
    root.append(this.page.problems.root);
    watchInput();
    window.addEventListener('hashchange', () => { this.route(); });
    this.page.addEventListener('leave', () => { this.close(); });
    this.page.addEventListener('again', () => {
      this.closeView();
      this.route();
    });
    if (this.query.problem !== null) this.page.problems.tell(this.query.problem.message, this.query.problem);
  }

  get models(): readonly Model[] {
    return this.query.only === null ? (this.watch.listing?.models ?? []) : [this.query.only];
  }

  /// Shows what the address says.
  route(): void {
    const address = parseAddress(location.hash);
    const model = this.query.only ?? (address === null ? null : this.modelAt(address.path));
    if (model !== null) {
      this.showModel(model, address ?? NOWHERE);
      return;
    }
    this.showGallery();
    if (address !== null) this.page.problems.tell(words.problems.unfetchable(shortened(readable(address.path))));
  }

  /// Opens a model of the listing by its name or path. False if there is none.
  open(name: string): boolean {
    const model = this.models.find((one) => one.name === name || one.path === name);
    if (model !== undefined) visit(formatAddress({ path: model.path, ...NOWHERE }));
    return model !== undefined;
  }

  /// From a model to the gallery.
  close(): void {
    if (this.query.only !== null || this.entry === null || this.entry.leave()) return;
    showAddress(this.galleryAddress);
    this.route();
  }

  private get galleryAddress(): string {
    return location.pathname + location.search;
  }

  /// `path`: as linkPath() has it. Null if it cannot be fetched.
  private modelAt(path: string): Model | null {
    return this.models.find((one) => linkPath(one.path) === path) ?? modelOfPath(path, this.query.listing);
  }

  private listed(listing: Listing): void {
    this.gallery?.update(listing);
    this.uploads?.offer(listing.upload);
    const isEmpty = (listing.part?.total ?? listing.models.length) + (listing.jobs?.length ?? 0) === 0;
    if (isEmpty) this.say(emptyText(listing, this.query.listing));
  }

  /// In the gallery, as soon as there is one.
  private say(text: string): void {
    this.said = text;
    this.gallery?.tell(text);
  }

  private showGallery(): void {
    this.closeView();
    takeBooted(null);
    document.title = 'meshhier';
    if (this.query.only === null) this.watch.start();
    if (this.gallery !== null) this.enter(this.gallery);
    else this.loadGallery().catch((error: unknown) => { this.page.problems.tell(messageOf(error), { more: words.problems.noCodeMore, retry: () => { this.route(); } }); });
  }

  private enter(gallery: Gallery): void {
    gallery.show();
    if (this.left !== null) gallery.focus(this.left);
  }

  /// Its code is of no use to who comes for one model.
  private async loadGallery(): Promise<void> {
    const { Gallery } = await import('./gallery/gallery.js');
    if (this.gallery !== null) return;
    const gallery = this.makeGallery(new Gallery(this.page, this.gallerySource()));
    this.gallery = gallery;
    gallery.tell(this.said);
    if (this.watch.listing !== null) this.listed(this.watch.listing);
    if (this.entry === null) this.enter(gallery);
  }

  private gallerySource(): GallerySource {
    const { query: { listing }, watch } = this;
    return {
      wished: () => { watch.start(); },
      fetchPart: (wish, first, state, signal) => watch.fetch(partAddress(listing, wish, { first: String(first), state }), signal),
      fetchPlaces: async (wish, signal) => (await watch.fetch(partAddress(listing, wish, { count: '0', places: '1' }), signal)).part?.places ?? [],
    };
  }

  private makeGallery(gallery: Gallery): Gallery {
    this.root.prepend(gallery.root);
    watchLinks(gallery.root);
    this.uploads = new UploadPlace(gallery, this.page.problems, new URL('inbox/', this.query.listing).href);
    gallery.root.addEventListener('stored', () => { if (gallery.shown) this.watch.start(); });
    for (const sign of ['pointerdown', 'pointerover', 'focusin'] as const)
      gallery.root.addEventListener(sign, () => { loadView().catch(() => undefined); }, { once: true });
    return gallery;
  }

  private showModel(model: Model, spot: Spot): void {
    if (this.entry?.model.url === model.url) {
      this.entry.arrive(false);
      this.view?.setSpot(spot);
      return;
    }
    this.closeView();
    const entry = new ModelEntry(model, this.query.only === null ? model.path : '');
    this.entry = entry;
    entry.arrive(leavesEntries && (this.gallery?.shown ?? false));
    const turn = this.gallery?.shown ? this.gallery.turnOf(model.path) : null;
    this.gallery?.hide();
    this.watch.stop();
    document.title = words.title(model.name);
    this.load(entry, spot, turn).catch((error: unknown) => { if (entry === this.entry) this.refuse(entry, messageOf(error), spot); });
  }

  private async load(entry: ModelEntry, spot: Spot, turn: Turn | null): Promise<void> {
    const { model } = entry;
    const early = new EarlyStart(model.files === undefined ? model.url : null);
    this.poster = early.poster;
    try {
      const { ModelView } = await loadView();
      if (entry !== this.entry) return;
      const { fetch, createWorker, poster } = early;
      const findStory = (signal: AbortSignal): Promise<string | null> => this.storyOf(model, signal);
      const findPermission = (signal: AbortSignal): Promise<boolean> => this.mayWriteViews(model, signal);
      const asksToken = (): boolean => this.asksToken;
      const findModels = async (signal: AbortSignal): Promise<readonly Model[]> => (await this.watch.once(signal)).models;
      this.view = new ModelView({
        page: this.page, entry, spot, turn, fetch, createWorker, poster, findStory, findPermission, asksToken, findModels, other: this.query.other, hasGallery: this.query.only === null,
      });
    } finally {
      early.close();
    }
    this.root.prepend(this.view.root);
    this.view.start();
  }

  /// Back to the gallery, where the model's link can be followed again; a visitor who is elsewhere by now stays there.
  private refuse({ model, current }: ModelEntry, why: string, spot: Spot): void {
    if (!current) {
      this.closeView();
      return;
    }
    history.replaceState(null, '', this.galleryAddress);
    this.showGallery();
    const retry = (): void => { visit(formatAddress({ path: model.path, ...spot })); };
    const { noWebGl, noWebGlMore, notShown } = words.problems;
    if (why === noWebGl) this.page.problems.tell(why, { more: noWebGlMore });
    else this.page.problems.tell(notShown(model.name), { more: why, retry });
  }

  /// The address of what is told about a model; a link to one says nothing of it, but the listing does.
  private async storyOf(model: Model, signal: AbortSignal): Promise<string | null> {
    if (model.story !== null || this.query.only !== null) return model.story;
    try {
      return (await this.watch.find(linkPath(model.path), signal))?.story ?? null;
    } catch {
      return null; // a model may be shown without any listing
    }
  }

  /// A model within the page, or one that was named without a listing, has nobody who would keep its view.
  private async mayWriteViews({ files, url }: Model, signal: AbortSignal): Promise<boolean> {
    if (files !== undefined || this.query.only !== null || new URL(url).origin !== location.origin) return false;
    const { upload } = await this.watch.once(signal);
    this.asksToken = upload?.token ?? false;
    return upload?.views === true && mayAsk(upload, this.query.listing);
  }

  /// Makes room for something else. What was told before anything was shown stays.
  private closeView(): void {
    if (this.entry !== null || this.gallery?.shown) this.page.problems.clear();
    this.left = this.entry?.model.path ?? null;
    this.entry = null;
    this.view?.close();
    this.view = null;
    this.poster?.end();
    this.poster = null;
  }
}
