// SPDX-License-Identifier: MIT
// The gallery's part for uploads. Its code comes when a server takes some, which a static host never does.
import type { UploadOffer } from '../listing.js';
import type { Surroundings, Uploader } from './uploader.js';

export class UploadPlace {
  private uploader: Promise<Uploader> | null = null;

  /// `insert` puts it into the gallery.
  constructor(private readonly insert: (section: HTMLElement) => void, private readonly around: Surroundings) {}

  /// Pages of other origins are refused by the server, and are not offered anything.
  offer(offer: UploadOffer | null): void {
    const isOwn = new URL(this.around.inbox).origin === location.origin;
    if (this.uploader === null && (offer === null || !isOwn)) return;
    this.uploader ??= this.load();
    this.uploader.then((uploader) => { uploader.show(offer); }, () => { this.uploader = null; });
  }

  private async load(): Promise<Uploader> {
    const { Uploader } = await import('./uploader.js');
    const uploader = new Uploader(this.around);
    this.insert(uploader.root);
    return uploader;
  }
}
