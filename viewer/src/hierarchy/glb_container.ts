// SPDX-License-Identifier: MIT
// The container of glTF binaries as meshhier writes them (docs/file_format.md, section 4.2).
import { HierarchyProblem } from './problem.js';

export interface Container {
  readonly document: unknown;
  /// The BIN chunk's data; null: there is no such chunk.
  readonly bin: Uint8Array | null;
}

/// As EXT_meshopt_compression has it.
export interface Compressed {
  byteOffset?: number;
  byteLength: number;
  byteStride: number;
  count: number;
  mode: string;
  filter?: string;
}

export interface BufferView {
  byteOffset?: number;
  byteLength: number;
  extensions?: { EXT_meshopt_compression?: Compressed };
}

const MAGIC = 0x46546c67; // "glTF"
const JSON_CHUNK = 0x4e4f534a;
const BIN_CHUNK = 0x004e4942;
export const HEAD_BYTES = 20;
export const CHUNK_HEAD_BYTES = 8;
const MOST_JSON_BYTES = 65536;

/// The lengths that the head of the file and that of the JSON chunk say.
export interface Head {
  /// The whole file has so many.
  readonly bytes: number;
  readonly jsonBytes: number;
}

function need(good: boolean, name: string, problem: string): void {
  if (!good) throw new HierarchyProblem(name, problem);
}

/// Reads the first HEAD_BYTES of a file, perhaps with more behind them. Throws HierarchyProblem if they are no head.
export function readHead(start: Uint8Array, name: string): Head {
  const view = new DataView(start.buffer, start.byteOffset, start.byteLength);
  need(start.byteLength >= HEAD_BYTES, name, 'is shorter than the head of a glTF binary');
  need(view.getUint32(0, true) === MAGIC && view.getUint32(4, true) === 2, name, 'is no glTF 2.0 binary');
  const [bytes, jsonBytes] = [view.getUint32(8, true), view.getUint32(12, true)];
  const fits = jsonBytes % 4 === 0 && jsonBytes <= MOST_JSON_BYTES && HEAD_BYTES + jsonBytes <= bytes;
  need(fits && view.getUint32(16, true) === JSON_CHUNK, name, 'has no JSON chunk that fits');
  return { bytes, jsonBytes };
}

/// Reads the JSON chunk.
export function parseDocument(text: Uint8Array, name: string): unknown {
  try {
    return JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(text));
  } catch {
    throw new HierarchyProblem(name, 'its JSON chunk is not JSON');
  }
}

/// Throws HierarchyProblem unless the chunks fill the file exactly.
export function readContainer(bytes: Uint8Array, name: string): Container {
  const head = readHead(bytes, name);
  need(head.bytes === bytes.byteLength, name, 'has another length than it says');
  const end = HEAD_BYTES + head.jsonBytes;
  const document = parseDocument(bytes.subarray(HEAD_BYTES, end), name);
  if (bytes.byteLength === end) return { document, bin: null };
  const begin = end + CHUNK_HEAD_BYTES;
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const isWhole = begin <= bytes.byteLength && view.getUint32(end, true) === bytes.byteLength - begin;
  need(isWhole && view.getUint32(end + 4, true) === BIN_CHUNK, name, 'has no BIN chunk that fits');
  return { document, bin: bytes.subarray(begin) };
}

/// Returns the end of a section's bytes in the BIN chunk.
export function endOf({ byteOffset = 0, byteLength, extensions }: BufferView): number {
  const packed = extensions?.EXT_meshopt_compression;
  return packed ? (packed.byteOffset ?? 0) + packed.byteLength : byteOffset + byteLength;
}
