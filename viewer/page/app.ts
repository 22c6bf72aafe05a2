// Shows what the address says: the gallery, or a model.
import { formatAddress, parseAddress, type Pose } from './address.js';
import { EarlyStart } from './early_start.js';
import { Gallery } from './gallery/gallery.js';
import { ListingWatch } from './listing_watch.js';
import { modelOfPath, type Listing, type Model } from './listing.js';
import { ModelEntry } from './model_entry.js';
import { element } from './parts/element.js';
import { ModeBadge } from './parts/mode_badge.js';
import { themeButton } from './parts/theme_button.js';
import { loadPreferences, savePreferences, type Theme } from './preferences.js';
import { NO_WEBGL } from './parts/no_webgl.js';
import { Problems } from './problems.js';
import { readQuery, shortened } from './query.js';
import { watchInput } from './parts/input.js';
import { applyTheme, watchSystemTheme } from './theme.js';
import type { ModelView, Surroundings } from './view/model_view.js';

/// What a folder without a model says, of a listing that knows where it lies.
function emptyText({ folder, inbox }: Listing): string {
  const how = inbox === null ? 'Hierarchies that "meshhier build" puts there appear here' : `Mesh files that are put into ${inbox} become some`;
  return `There are no hierarchies in ${folder} yet. ${how}.`;
}

const HOW_TO = 'Put a file models.json beside this page, {"models": [{"path": "NAME.hier"}]}, or let "meshhier serve" do it, ' +
  'or name a hierarchy in the address: ?model=NAME.hier';

/// A browser's word for code that did not come says nothing to people.
function messageOf(error: unknown): string {
  if (error instanceof TypeError) return "the page's code could not be fetched";
  return error instanceof Error ? error.message : String(error);
}

/// The view's code: once, when it is likely to be wanted.
function loadView(): Promise<typeof import('./view/model_view.js')> {
  return import('./view/model_view.js');
}

function unreachable(path: string): string {
  return `The link names "${shortened(path)}", which cannot be fetched.`;
}

export class App {
  readonly preferences = loadPreferences();
  readonly problems = new Problems();
  view: ModelView | null = null;
  private readonly query = readQuery(location.search, document.baseURI);
  private readonly watch: ListingWatch;
  private gallery: Gallery | null = null;
  private entry: ModelEntry | null = null; // of the model that is shown: what was loaded for an earlier one is of no use
  private left: string | null = null;

  constructor(private readonly root: HTMLElement) {
    this.watch = new ListingWatch(
      this.query.listing,
      (listing) => { this.listed(listing); },
      (message) => { this.gallery?.tell(`There are no models to show: ${message}. ${HOW_TO}`); },
    );
    root.append(this.problems.root);
    applyTheme(this.preferences.theme);
    watchSystemTheme(() => { this.setTheme(this.preferences.theme); });
    watchInput();
    window.addEventListener('hashchange', () => { this.route(); });
    if (this.query.problem !== null) this.problems.tell(this.query.problem);
  }

  get models(): readonly Model[] {
    return this.query.only === null ? (this.watch.listing?.models ?? []) : [this.query.only];
  }

  /// Shows what the address says.
  route(): void {
    const address = parseAddress(location.hash);
    const model = this.query.only ?? (address === null ? null : this.modelAt(address.path));
    if (model !== null) {
      this.showModel(model, address?.pose ?? null);
      return;
    }
    this.showGallery();
    if (address !== null) this.problems.tell(unreachable(address.path));
  }

  /// Opens a model of the listing by its name or path. False if there is none.
  open(name: string): boolean {
    const model = this.models.find((one) => one.name === name || one.path === name);
    if (model !== undefined) location.hash = formatAddress({ path: model.path, pose: null });
    return model !== undefined;
  }

  /// From a model to the gallery.
  close(): void {
    if (this.query.only !== null || this.entry === null || this.entry.leave()) return;
    history.pushState(null, '', this.galleryAddress);
    this.route();
  }

  setTheme(theme: Theme): void {
    this.preferences.theme = theme;
    savePreferences(this.preferences);
    applyTheme(theme);
    this.gallery?.themeChanged();
    this.view?.themeChanged();
  }

  private get galleryAddress(): string {
    return location.pathname + location.search;
  }

  /// Null of a path that cannot be fetched.
  private modelAt(path: string): Model | null {
    return this.models.find((one) => one.path === path) ?? modelOfPath(path, this.query.listing);
  }

  private listed(listing: Listing): void {
    this.gallery?.update(listing);
    const isEmpty = listing.models.length + (listing.jobs?.length ?? 0) === 0;
    if (isEmpty) this.gallery?.tell(listing.folder === null ? `The listing ${this.query.listing} is empty. ${HOW_TO}` : emptyText(listing));
  }

  private showGallery(): void {
    this.closeView();
    this.gallery ??= this.makeGallery();
    document.title = 'meshhier';
    this.gallery.show();
    if (this.query.only === null) this.watch.start();
    if (this.left !== null) this.gallery.focus(this.left);
  }

  private makeGallery(): Gallery {
    const badge = new ModeBadge();
    badge.show('TP');
    const theme = themeButton(() => this.preferences.theme, (chosen) => { this.setTheme(chosen); });
    const gallery = new Gallery(element('header', { class: 'gallery-header' }, element('h1', {}, 'meshhier'), badge.root, theme));
    this.root.prepend(gallery.root);
    for (const sign of ['pointerdown', 'pointerover', 'focusin'] as const)
      gallery.root.addEventListener(sign, () => { loadView().catch(() => undefined); }, { once: true });
    if (!gallery.works) this.problems.tell(NO_WEBGL);
    return gallery;
  }

  private showModel(model: Model, pose: Pose | null): void {
    if (this.entry?.model.url === model.url) {
      this.entry.arrive(false);
      this.view?.setPose(pose);
      return;
    }
    this.closeView();
    const entry = new ModelEntry(model, this.query.only === null ? model.path : '');
    this.entry = entry;
    entry.arrive(this.gallery?.shown ?? false);
    this.gallery?.hide();
    this.watch.stop();
    document.title = `${model.name} – meshhier`;
    this.load(entry, pose).catch((error: unknown) => { if (entry === this.entry) this.refuse(entry, messageOf(error), pose); });
  }

  private async load(entry: ModelEntry, pose: Pose | null): Promise<void> {
    const { model } = entry;
    const early = new EarlyStart(model.url);
    try {
      const { ModelView } = await loadView();
      if (entry !== this.entry) return;
      this.view = new ModelView(model, this.surroundings(entry, pose, early));
    } finally {
      early.close();
    }
    this.root.prepend(this.view.root);
    this.view.start();
  }

  /// Back to the gallery, where the model's link can be followed again; a visitor who is elsewhere by now stays there.
  private refuse({ model, current }: ModelEntry, why: string, pose: Pose | null): void {
    if (!current) {
      this.closeView();
      return;
    }
    history.replaceState(null, '', this.galleryAddress);
    this.showGallery();
    const retry = (): void => { location.hash = formatAddress({ path: model.path, pose }); };
    this.problems.tell(why === NO_WEBGL ? why : `${model.name} cannot be shown: ${why}.`, { retry: why === NO_WEBGL ? null : retry });
  }

  private surroundings(entry: ModelEntry, pose: Pose | null, { fetch, createWorker }: EarlyStart): Surroundings {
    return {
      fetch,
      createWorker,
      pose,
      preferences: this.preferences,
      chosen: () => { savePreferences(this.preferences); },
      setTheme: (theme) => { this.setTheme(theme); },
      leave: this.query.only === null ? () => { this.close(); } : null,
      rested: (rest) => { entry.write(rest); },
      failed: (message, telling) => this.problems.tell(message, telling),
      again: () => {
        this.closeView();
        this.route();
      },
    };
  }

  /// Makes room for something else. What was told before anything was shown stays.
  private closeView(): void {
    if (this.entry !== null || this.gallery?.shown) this.problems.clear();
    this.left = this.entry?.model.path ?? null;
    this.entry = null;
    this.view?.close();
    this.view = null;
  }
}
