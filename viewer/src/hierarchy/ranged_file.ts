// SPDX-License-Identifier: MIT
// One file over HTTP, of which parts are read (RFC 9110, section 14).
import { receive, receivePieces, respond, type Asking, type Fetch } from './bytes.js';
import { HierarchyProblem, HierarchyReplaced } from './problem.js';

/// Parts that lie so near to each other come in one answer.
const MOST_GAP = 2 ** 14;
/// One answer has no more bytes, unless one part has.
const MOST_TOGETHER = 2 ** 23;
/// A file of which the host sends no parts is fetched whole if it has no more bytes.
const MOST_WHOLE = 2 ** 26;

/// A part that is asked for.
interface WantedPart {
  readonly first: number;
  readonly end: number;
  readonly init: Asking;
  readonly resolve: (bytes: Uint8Array<ArrayBuffer>) => void;
  readonly reject: (problem: unknown) => void;
}

/// These tell one version of a file from another, as far as the host lets the page see them.
interface Version {
  readonly tag: string | null;
  readonly modified: string | null;
  readonly total: number | null;
}

function versionOf({ headers }: Response, total: number | null): Version {
  return { tag: headers.get('ETag')?.replace(/^W\//, '') ?? null, modified: headers.get('Last-Modified'), total };
}

/// Tells whether both are known and not the same.
function differ<T>(one: T | null, other: T | null): boolean {
  return one !== null && other !== null && one !== other;
}

interface ContentRange {
  readonly first: number;
  readonly total: number | null;
}

/// The header that asks for bytes [first, end).
export function rangeHeader(first: number, end: number): { Range: string } {
  return { Range: `bytes=${first}-${end - 1}` };
}

/// Null: the page may not see it, or there is none.
function contentRange(response: Response): ContentRange | null {
  const match = /^bytes (\d+)-\d+\/(\d+|\*)$/.exec(response.headers.get('Content-Range') ?? '');
  return match && { first: Number(match[1]), total: match[2] === '*' ? null : Number(match[2]) };
}

/// Says what is wrong with a length that no file has: places in it could not be told from their neighbours. Null: nothing.
function problemOfLength(total: number | null): string | null {
  return total === null || Number.isSafeInteger(total) ? null : `the host says that it has ${total} bytes, as no file has`;
}

/// Copies what comes into the parts that it belongs to; each is given as soon as it is there.
class Parts {
  private readonly waiting: { wanted: WantedPart; bytes: Uint8Array<ArrayBuffer> }[];

  constructor(wanted: readonly WantedPart[]) {
    this.waiting = wanted.map((each) => ({ wanted: each, bytes: new Uint8Array(each.end - each.first) }));
  }

  /// `at`: of the first of the bytes, in the file.
  take(at: number, bytes: Uint8Array): void {
    for (const { wanted, bytes: to } of this.waiting) {
      const from = Math.max(wanted.first, at);
      const end = Math.min(wanted.end, at + bytes.length);
      if (from >= end) continue;
      const piece = bytes.subarray(from - at, end - at);
      to.set(piece, from - wanted.first);
      wanted.init.watch?.(piece);
      if (end === wanted.end) wanted.resolve(to);
    }
  }
}

export class RangedFile {
  private version: Version | null = null;
  private whole: Uint8Array<ArrayBuffer> | null = null; // of a host that knows no ranges
  private queue: WantedPart[] = [];

  /// `name`: for messages.
  constructor(
    readonly url: string,
    readonly name: string,
    private readonly fetch: Fetch,
  ) {}

  /// Bytes [first, end): fewer only if the file ends before. Throws HierarchyProblem, and what ends `init.signal`.
  async readUpTo(first: number, end: number, init: RequestInit = {}): Promise<Uint8Array<ArrayBuffer>> {
    if (this.whole !== null) return this.whole.slice(first, end);
    const response = await respond(this.fetch, this.url, this.name, { ...init, headers: rangeHeader(first, end) });
    if (response.status === 200) return (await this.readWhole(response, init.signal)).slice(first, end);
    this.check(response, first);
    return receive(response, end - first, this.name, init);
  }

  /// Bytes [first, end). Together with others that are asked for at the same time and lie near.
  async read(first: number, end: number, init: Asking = {}): Promise<Uint8Array<ArrayBuffer>> {
    init.signal?.throwIfAborted();
    if (this.whole !== null) return this.partOfWhole(first, end);
    return new Promise((resolve, reject) => {
      if (this.queue.length === 0) setTimeout(() => { this.flush(); });
      this.queue.push({ first, end, init, resolve, reject });
    });
  }

  /// Returns the bytes of the file.
  async size(): Promise<number> {
    if (this.whole !== null) return this.whole.length;
    if (this.version?.total != null) return this.version.total;
    // The page may not see Content-Range, but it may see this.
    const response = await respond(this.fetch, this.url, this.name, { method: 'HEAD' });
    const length = response.headers.get('Content-Length');
    if (length === null || !/^\d+$/.test(length)) throw new HierarchyProblem(this.name, 'the host does not tell how long it is');
    const impossible = problemOfLength(Number(length));
    if (impossible !== null) throw new HierarchyProblem(this.name, impossible);
    this.note(versionOf(response, Number(length)));
    return Number(length);
  }

  /// Tells this version from others; null: the page may not see it.
  get versionText(): string | null {
    const { tag = null, modified = null, total = null } = this.version ?? {};
    return tag === null && modified === null ? null : `${tag ?? ''} ${modified ?? ''} ${total ?? ''}`;
  }

  private flush(): void {
    const queue = this.queue.filter(({ init, reject }) => {
      if (init.signal?.aborted) reject(init.signal.reason);
      return !init.signal?.aborted;
    });
    this.queue = [];
    queue.sort((a, b) => a.first - b.first);
    let group: WantedPart[] = [];
    let end = 0;
    for (const wanted of queue) {
      const isNear = wanted.first - end <= MOST_GAP && group.length > 0 && wanted.end - group[0].first <= MOST_TOGETHER;
      if (!isNear && group.length > 0) void this.fetchTogether(group, end);
      if (!isNear) group = [];
      group.push(wanted);
      end = Math.max(isNear ? end : 0, wanted.end);
    }
    if (group.length > 0) void this.fetchTogether(group, end);
  }

  /// Ends when all who wait for it have gone.
  private async fetchTogether(group: readonly WantedPart[], end: number): Promise<void> {
    const ending = new AbortController();
    const done = new AbortController(); // nobody listens any more
    let left = group.length;
    for (const { init: { signal }, reject } of group)
      signal?.addEventListener('abort', () => {
        reject(signal.reason);
        if (--left === 0) ending.abort(signal.reason);
      }, { once: true, signal: done.signal });
    try {
      await this.fetchParts(group, end, ending.signal);
    } catch (problem) {
      for (const { reject } of group) reject(problem); // of what has come already nothing happens
    } finally {
      done.abort();
    }
  }

  private async fetchParts(group: readonly WantedPart[], end: number, signal: AbortSignal): Promise<void> {
    const { first } = group[0];
    const init = { ...group[0].init, signal, headers: rangeHeader(first, end) };
    const response = await respond(this.fetch, this.url, this.name, init);
    if (response.status === 200) {
      await this.readWhole(response, signal);
      for (const { first, end, resolve } of group) resolve(this.partOfWhole(first, end));
      return;
    }
    this.check(response, first);
    const parts = new Parts(group);
    let at = first;
    const take = (piece: Uint8Array): void => {
      parts.take(at, piece);
      at += piece.length;
    };
    await receivePieces(response, end - first, this.name, signal, take);
    if (at < end) throw new HierarchyProblem(this.name, 'broke off', true);
  }

  private partOfWhole(first: number, end: number): Uint8Array<ArrayBuffer> {
    const part = this.whole!.slice(first, end);
    if (part.length < end - first) throw new HierarchyProblem(this.name, 'is cut or damaged: something in it should be where it has ended');
    return part;
  }

  /// Reads the whole file, which the host sent instead of a part.
  private async readWhole(response: Response, signal: AbortSignal | null | undefined): Promise<Uint8Array<ArrayBuffer>> {
    const length = Number(response.headers.get('Content-Length') ?? 0);
    const refuse = (): never => {
      throw new HierarchyProblem(this.name, 'the host sends files whole, but no parts of them (HTTP ranges), and this one is too long for that: '
        + 'put it on a host that knows ranges, or put the directory of the hierarchy there');
    };
    if (length > MOST_WHOLE) {
      void response.body?.cancel();
      return refuse();
    }
    try {
      this.whole = await receive(response, MOST_WHOLE, this.name, { signal });
    } catch (problem) {
      if (problem instanceof HierarchyProblem && !problem.mayPass) refuse();
      throw problem;
    }
    return this.whole;
  }

  /// Throws HierarchyProblem if an answer is no part that begins there, or of another version than those before.
  private check(response: Response, first: number): void {
    const range = contentRange(response);
    const isOther = response.status !== 206 || (range !== null && range.first !== first);
    const impossible = problemOfLength(range?.total ?? null);
    if (isOther || impossible !== null) {
      void response.body?.cancel();
      throw new HierarchyProblem(this.name, isOther ? 'the host sent something else than the part that was asked for' : impossible!, isOther);
    }
    this.note(versionOf(response, range?.total ?? null));
  }

  private note(version: Version): void {
    const { version: before } = this;
    if (before === null) {
      this.version = version;
      return;
    }
    const { tag, modified, total } = version;
    if (differ(before.tag, tag) || differ(before.modified, modified) || differ(before.total, total))
      throw new HierarchyReplaced(this.name);
    this.version = { tag: before.tag ?? tag, modified: before.modified ?? modified, total: before.total ?? total };
  }
}
