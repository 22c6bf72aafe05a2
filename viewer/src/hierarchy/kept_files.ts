// SPDX-License-Identifier: MIT
// Files of archives that the browser keeps for the next visit (CacheStorage; secure pages have it). Browsers themselves keep few parts of
// files.

const PREFIX = 'meshhier ';
/// No more of one archive is kept.
const MOST_BYTES = 2 ** 28;
/// Archives of this origin that are kept; the one opened first goes first.
const MOST_ARCHIVES = 8;

/// The store of one version of an archive. What fails is as if it were not there: nothing depends on it.
export class KeptFiles {
  private readonly store: Promise<Cache | null>;
  private bytes = 0;

  /// `version`: as the host tells it. `caches`: the browser's.
  constructor(url: string, version: string, caches: CacheStorage) {
    this.store = KeptFiles.open(`${PREFIX}${url} `, version, caches).catch(() => null);
  }

  async find(name: string): Promise<Uint8Array<ArrayBuffer> | null> {
    try {
      const found = await (await this.store)?.match(keyOf(name));
      return found === undefined ? null : new Uint8Array(await found.arrayBuffer());
    } catch {
      return null;
    }
  }

  keep(name: string, bytes: Uint8Array<ArrayBuffer>): void {
    if (this.bytes + bytes.length > MOST_BYTES) return;
    this.bytes += bytes.length;
    void this.store.then((store) => store?.put(keyOf(name), new Response(bytes))).catch(() => undefined);
  }

  /// Other versions of the archive go, and what is too much.
  private static async open(archive: string, version: string, caches: CacheStorage): Promise<Cache> {
    const own = archive + version;
    const there = (await caches.keys()).filter((key) => key.startsWith(PREFIX) && key !== own);
    const others = there.filter((key) => !key.startsWith(archive));
    const gone = [...there.filter((key) => key.startsWith(archive)), ...others.slice(0, Math.max(0, others.length - MOST_ARCHIVES + 1))];
    await Promise.all(gone.map((key) => caches.delete(key)));
    return caches.open(own);
  }
}

/// Requests need an address; nothing is fetched from it.
function keyOf(name: string): string {
  return `https://archive.invalid/${name}`;
}

/// Null where the browser has none.
export function browserStore(): CacheStorage | null {
  try {
    return globalThis.caches ?? null; // pages in some frames may not even look
  } catch {
    return null;
  }
}
