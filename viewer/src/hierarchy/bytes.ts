// SPDX-License-Identifier: MIT
// Files over HTTP, or over whatever `fetch` is given.
import { HierarchyProblem } from './problem.js';

export type Fetch = (url: string, init?: RequestInit) => Promise<Response>;

/// How a file is asked for.
export interface Asking extends RequestInit {
  /// Is given the pieces of a file as they come, once each and in order; not all who have files have pieces of them.
  readonly watch?: (piece: Uint8Array) => void;
}

/// A host that sends nothing for so long does not answer: it may have taken the connection, and no more.
const SILENT_MS = 20_000;

/// Resolves as `awaited` does, if that is in time. Else it is ended by `giveUp`, and a problem of `name` that may pass is thrown.
export async function inTime<T>(awaited: Promise<T>, name: string, giveUp: () => void): Promise<T> {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const late = new Promise<never>((_, reject) => {
    timer = setTimeout(() => {
      reject(new HierarchyProblem(name, `the host has sent nothing for ${SILENT_MS / 1000} seconds`, true));
      giveUp();
    }, SILENT_MS);
  });
  try {
    return await Promise.race([awaited, late]);
  } finally {
    clearTimeout(timer);
  }
}

/// Reads the next piece of a stream.
type NextPiece = (reader: ReadableStreamDefaultReader<Uint8Array>) => Promise<ReadableStreamReadResult<Uint8Array>>;

/// Receives pieces in time.
function receivePiece(name: string): NextPiece {
  return (reader) => inTime(reader.read(), name, () => { reader.cancel().catch(() => undefined); });
}

/// In time that grows with the text alone; `/\/+$/` looks at each run of slashes again from each of them.
export function withoutLastSlashes(text: string): string {
  let end = text.length;
  while (text[end - 1] === '/') --end;
  return text.slice(0, end);
}

export function isGzip(bytes: Uint8Array): boolean {
  return bytes[0] === 0x1f && bytes[1] === 0x8b;
}

function joined(pieces: readonly Uint8Array[], length: number): Uint8Array<ArrayBuffer> {
  const all = new Uint8Array(length);
  let at = 0;
  for (const piece of pieces) {
    all.set(piece, at);
    at += piece.length;
  }
  return all;
}

/// Hands out all that a stream gives, at most `most` bytes; more is a problem of `name`. Returns how many they were.
async function pour(stream: ReadableStream<Uint8Array>, most: number, name: string, take: (piece: Uint8Array) => void, next: NextPiece = (reader) => reader.read()): Promise<number> {
  let length = 0;
  const reader = stream.getReader();
  for (;;) {
    const { done, value } = await next(reader);
    if (done) return length;
    length += value.length;
    if (length > most) {
      await reader.cancel();
      throw new HierarchyProblem(name, `larger than ${most} bytes`);
    }
    take(value);
  }
}

/// At most `most` bytes of a stream; more is a problem of `name`.
export async function drain(stream: ReadableStream<Uint8Array>, most: number, name: string): Promise<Uint8Array<ArrayBuffer>> {
  const pieces: Uint8Array[] = [];
  return joined(pieces, await pour(stream, most, name, (piece) => { pieces.push(piece); }));
}

/// How tiles are stored: whether in gzip as a whole.
export const COMPRESSIONS = { none: false, zlib: true, meshopt: false, meshopt_zlib: true };
export const COMPRESSION_NAMES = Object.keys(COMPRESSIONS) as (keyof typeof COMPRESSIONS)[];

/// A host that does not send Content-Encoding with a file in gzip leaves it to us.
export async function unpacked(bytes: Uint8Array<ArrayBuffer>, most: number, name: string): Promise<Uint8Array<ArrayBuffer>> {
  if (!isGzip(bytes)) return bytes;
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  try {
    return await drain(stream, most, name);
  } catch (problem) {
    if (problem instanceof HierarchyProblem) throw problem;
    throw new HierarchyProblem(name, 'its gzip is damaged');
  }
}

/// Answers of a host that is busy, or of what stands before it: the same may succeed later.
function passes(status: number): boolean {
  return status === 408 || status === 425 || status >= 429;
}

/// Each of these ends the request of an answer whose body is still awaited.
const requests = new WeakMap<Response, AbortController>();

/// The host's answer, if one comes in time and is a good one. Throws HierarchyProblem of `name`, and what ends `init.signal`.
export async function respond(fetch: Fetch, url: string, name: string, init: RequestInit): Promise<Response> {
  const ending = new AbortController();
  const end = (): void => { ending.abort(init.signal?.reason); };
  if (init.signal?.aborted) end();
  init.signal?.addEventListener('abort', end, { once: true, signal: ending.signal });
  let response: Response;
  try {
    response = await inTime(fetch(url, { ...init, signal: ending.signal }), name, () => { ending.abort(); });
  } catch (problem) {
    if (init.signal?.aborted || problem instanceof HierarchyProblem) throw problem;
    throw new HierarchyProblem(name, 'could not be fetched; is the host up, and does it allow this page?', true);
  }
  if (response.ok) {
    requests.set(response, ending);
    return response;
  }
  ending.abort();
  throw new HierarchyProblem(name, `the host answered ${response.status}`, passes(response.status));
}

/// The pieces of an answer's body as they come, at most `most` bytes. Returns how many they were. Throws as respond() does.
export async function receivePieces(
  response: Response,
  most: number,
  name: string,
  signal: AbortSignal | null | undefined,
  take: (piece: Uint8Array) => void,
): Promise<number> {
  const { body } = response;
  if (body === null) throw new HierarchyProblem(name, 'is empty');
  try {
    return await pour(body, most, name, take, receivePiece(name));
  } catch (problem) {
    if (signal?.aborted || problem instanceof HierarchyProblem) throw problem;
    throw new HierarchyProblem(name, 'broke off', true);
  } finally {
    requests.get(response)?.abort(); // nobody listens for its end any more
  }
}

/// The body of an answer, at most `most` bytes. Throws as respond() does.
export async function receive(
  response: Response,
  most: number,
  name: string,
  { signal, watch }: Asking,
): Promise<Uint8Array<ArrayBuffer>> {
  const pieces: Uint8Array[] = [];
  const take = (piece: Uint8Array): void => {
    pieces.push(piece);
    watch?.(piece);
  };
  return joined(pieces, await receivePieces(response, most, name, signal, take));
}

/// A file of at most `most` bytes as the host sends it, perhaps in gzip.
export async function fetchStored(fetch: Fetch, url: string, name: string, most: number, init: Asking = {}): Promise<Uint8Array<ArrayBuffer>> {
  return receive(await respond(fetch, url, name, init), most, name, init);
}

/// The content of a file of at most `most` bytes, out of its gzip.
export async function fetchBytes(
  fetch: Fetch,
  url: string,
  name: string,
  most: number,
  init: RequestInit = {},
): Promise<Uint8Array<ArrayBuffer>> {
  return unpacked(await fetchStored(fetch, url, name, most, init), most, name);
}

/// More than this is not fetched whole for a part of it.
const MOST_WHOLE = 2 ** 26;

/// Bytes [first, end) of a file of `length`, or all of it where the host knows no ranges; as they are stored.
export async function fetchRange(
  fetch: Fetch,
  url: string,
  name: string,
  [first, end]: [number, number],
  length: number,
  signal: AbortSignal,
): Promise<Uint8Array<ArrayBuffer>> {
  return fetchStored(fetch, url, name, Math.min(length, MOST_WHOLE), { signal, headers: { Range: `bytes=${first}-${end - 1}` } });
}
