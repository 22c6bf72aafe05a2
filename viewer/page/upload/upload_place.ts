// SPDX-License-Identifier: MIT
// The gallery's part for uploads. Its code comes when a server takes some, which a static host never does.
import type { Gallery } from '../gallery/gallery.js';
import type { UploadOffer } from '../listing.js';
import type { Problems } from '../problems.js';
import type { Uploader } from './uploader.js';

export class UploadPlace {
  private uploader: Promise<Uploader> | null = null;

  /// `inbox`: its address, with a slash at its end.
  constructor(private readonly gallery: Gallery, private readonly problems: Problems, private readonly inbox: string) {}

  /// Pages of other origins are refused by the server, and are not offered anything.
  offer(offer: UploadOffer | null): void {
    const isOwn = new URL(this.inbox).origin === location.origin;
    if (this.uploader === null && (offer === null || !isOwn)) return;
    this.uploader ??= this.load();
    this.uploader.then((uploader) => { uploader.show(offer); }, () => { this.uploader = null; });
  }

  private async load(): Promise<Uploader> {
    const { Uploader } = await import('./uploader.js');
    const uploader = new Uploader(this.gallery.root, this.problems, this.inbox);
    this.gallery.insert(uploader.root);
    return uploader;
  }
}
