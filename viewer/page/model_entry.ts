// SPDX-License-Identifier: MIT
// The history entry of an open model: what the page writes into it, and the way back from it.
import { formatAddress, type Spot } from './address.js';
import type { Model } from './listing.js';

/// An entry keeps how it was reached. From the gallery: going back leads there.
interface Origin {
  fromGallery: boolean;
}

export class ModelEntry {
  private hash = '';
  private leaving = false;

  /// `path`: of the model, as the address has it.
  constructor(
    readonly model: Model,
    private readonly path: string,
    private readonly page: Pick<Window, 'history' | 'location'> = window,
  ) {}

  /// False once the visitor is elsewhere, or on the way there. The page is told only later (`hashchange`): what it writes until
  /// then is written into another entry.
  get current(): boolean {
    return !this.leaving && this.page.location.hash === this.hash;
  }

  /// The model is shown at the entry where the visitor is now. How an entry was reached counts the first time only.
  arrive(fromGallery: boolean): void {
    const { history, location } = this.page;
    if (history.state === null) history.replaceState({ fromGallery } satisfies Origin, '');
    this.hash = location.hash;
    this.leaving = false;
  }

  /// Keeps what is seen; of a model that was left, nothing.
  write(spot: Spot): void {
    if (!this.current) return;
    const { history, location } = this.page;
    history.replaceState(history.state, '', formatAddress({ path: this.path, ...spot }));
    this.hash = location.hash;
  }

  /// Goes back to the gallery, once. False if that is not where back leads.
  leave(): boolean {
    if (!this.current) return true;
    const { history } = this.page;
    this.leaving = (history.state as Origin | null)?.fromGallery ?? false;
    if (this.leaving) history.back();
    return this.leaving;
  }
}
