// SPDX-License-Identifier: MIT
// Files over HTTP, or over whatever `fetch` is given.
import { HierarchyProblem } from './problem.js';

export type Fetch = (url: string, init?: RequestInit) => Promise<Response>;

/// In time that grows with the text alone; `/\/+$/` looks at each run of slashes again from each of them.
export function withoutLastSlashes(text: string): string {
  let end = text.length;
  while (text[end - 1] === '/') --end;
  return text.slice(0, end);
}

function isGzip(bytes: Uint8Array): boolean {
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
async function pour(stream: ReadableStream<Uint8Array>, most: number, name: string, take: (piece: Uint8Array) => void): Promise<number> {
  let length = 0;
  const reader = stream.getReader();
  for (;;) {
    const { done, value } = await reader.read();
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

/// The host's answer, if it is a good one. Throws HierarchyProblem of `name`, and what ends `init.signal`.
export async function respond(fetch: Fetch, url: string, name: string, init: RequestInit): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(url, init);
  } catch (problem) {
    if (init.signal?.aborted) throw problem;
    throw new HierarchyProblem(name, 'could not be fetched; is the host up, and does it allow this page?', true);
  }
  if (response.ok) return response;
  void response.body?.cancel();
  throw new HierarchyProblem(name, `the host answered ${response.status}`, response.status >= 429);
}

/// The pieces of an answer's body as they come, at most `most` bytes. Returns how many they were. Throws as respond() does.
export async function receivePieces(
  { body }: Response,
  most: number,
  name: string,
  signal: AbortSignal | null | undefined,
  take: (piece: Uint8Array) => void,
): Promise<number> {
  if (body === null) throw new HierarchyProblem(name, 'is empty');
  try {
    return await pour(body, most, name, take);
  } catch (problem) {
    if (signal?.aborted || problem instanceof HierarchyProblem) throw problem;
    throw new HierarchyProblem(name, 'broke off', true);
  }
}

/// The body of an answer, at most `most` bytes. Throws as respond() does.
export async function receive(
  response: Response,
  most: number,
  name: string,
  signal: AbortSignal | null | undefined,
): Promise<Uint8Array<ArrayBuffer>> {
  const pieces: Uint8Array[] = [];
  return joined(pieces, await receivePieces(response, most, name, signal, (piece) => { pieces.push(piece); }));
}

/// The content of a file of at most `most` bytes, out of its gzip.
export async function fetchBytes(
  fetch: Fetch,
  url: string,
  name: string,
  most: number,
  init: RequestInit = {},
): Promise<Uint8Array<ArrayBuffer>> {
  const response = await respond(fetch, url, name, init);
  return unpacked(await receive(response, most, name, init.signal), most, name);
}

/// More than this is not fetched whole for a part of it.
const MOST_WHOLE = 2 ** 26;

/// Bytes [first, end) of a file of `length`, or all of it where the host knows no ranges.
export async function fetchRange(
  fetch: Fetch,
  url: string,
  name: string,
  [first, end]: [number, number],
  length: number,
  signal: AbortSignal,
): Promise<Uint8Array<ArrayBuffer>> {
  return fetchBytes(fetch, url, name, Math.min(length, MOST_WHOLE), { signal, headers: { Range: `bytes=${first}-${end - 1}` } });
}
