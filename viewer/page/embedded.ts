// SPDX-License-Identifier: MIT
// A hierarchy, or the beginning of one, within the page itself (`meshhier page`): JSON in a script element.
import { JsonValue } from '../src/json_value.js';
import { unpacked, type Asking } from '../src/hierarchy/bytes.js';
import { HierarchyProblem } from '../src/hierarchy/problem.js';
import { MANIFEST, MOST_MANIFEST_BYTES } from '../src/hierarchy/manifest_file.js';
import type { RemoteFiles, FilePlace } from '../src/hierarchy/files.js';
import { remoteFiles } from '../src/hierarchy/remote_files.js';
import type { Model } from './listing.js';

export const ID = 'meshhier-hierarchy';
/// A link that failed is tried again after this time, or when the browser says that it is online.
const OFFLINE_MS = 30_000;

function decoded(base64: string): Uint8Array<ArrayBuffer> {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

/// Names are as in a hierarchy; of the index there may be the beginning only.
export class EmbeddedFiles implements RemoteFiles {
  private offlineUntil = 0;
  private readonly lengths = new Map<string, number>(); // of files that parts were asked of

  /// `files`: in base64, and perhaps in gzip. `link`: has what is not among them; null: nothing has.
  constructor(
    private readonly files: ReadonlyMap<string, string>,
    private link: RemoteFiles | null,
  ) {
    globalThis.addEventListener?.('online', () => { this.offlineUntil = 0; });
  }

  lacks(name: string): boolean {
    return !this.files.has(name) && !this.reaches;
  }

  /// Files of this page were checked when it was made; a part counts once it was asked for.
  holds(name: string, end = 0): boolean {
    return this.files.has(name) && (this.lengths.get(name) ?? 0) >= end;
  }

  /// Without its gzip where this page has it.
  async stored(name: string, most: number, init?: Asking, where?: FilePlace): Promise<Uint8Array<ArrayBuffer>> {
    const file = this.files.get(name);
    if (file !== undefined) return this.held(name, await unpacked(decoded(file), most, name));
    return this.ask(name, (link) => link.stored(name, most, init, where));
  }

  /// That of the host, if there is one.
  async manifestNow(signal: AbortSignal): Promise<Uint8Array<ArrayBuffer>> {
    return this.link?.manifestNow(signal) ?? this.stored(MANIFEST, MOST_MANIFEST_BYTES, { signal });
  }

  setBuild(name: string): void {
    this.link?.setBuild?.(name);
  }

  leaveHost(): boolean {
    this.link = null;
    return true;
  }

  async part(name: string, [first, end]: [number, number], length: number, signal: AbortSignal): Promise<Uint8Array<ArrayBuffer>> {
    const file = this.files.get(name);
    const start = file === undefined ? null : this.held(name, await unpacked(decoded(file), length, name));
    if (start !== null && start.length >= end) return start.subarray(first, end);
    return this.ask(name, (link) => link.part(name, [first, end], length, signal));
  }

  private held<Bytes extends Uint8Array>(name: string, bytes: Bytes): Bytes {
    this.lengths.set(name, bytes.length);
    return bytes;
  }

  private get reaches(): boolean {
    return this.link !== null && performance.now() >= this.offlineUntil;
  }

  /// Files that could not be had by the line are lacking for a while.
  private async ask<T>(name: string, from: (link: RemoteFiles) => Promise<T>): Promise<T> {
    if (this.link === null) throw new HierarchyProblem(name, 'is not in this page');
    try {
      return await from(this.link);
    } catch (problem) {
      if (problem instanceof HierarchyProblem && problem.mayPass) this.offlineUntil = performance.now() + OFFLINE_MS;
      throw problem;
    }
  }
}

/// Null: the page has none. Throws Error if what it has is none.
export function embeddedModel(page: Pick<Document, 'getElementById' | 'baseURI'>): Model | null {
  const text = page.getElementById(ID)?.textContent;
  if (text == null) return null;
  const root = JsonValue.parse(text, (what) => { throw new Error(`this page is damaged: ${what}`); });
  const link = root.has('link') ? root.at('link').text() : null;
  const story = root.has('story') ? root.at('story').text() : null;
  const files = new Map(root.at('files').entries().map(([name, content]) => [name, content.text()]));
  const fetch = (url: string, init?: RequestInit): Promise<Response> => globalThis.fetch(url, init);
  const model: Model = { name: root.at('name').text(), path: '', url: link ?? page.baseURI, vertices: null, triangles: null, bytes: null, source: null, modified: null, preview: null, story };
  return { ...model, files: new EmbeddedFiles(files, link === null ? null : remoteFiles(link, fetch)) };
}
