// SPDX-License-Identifier: MIT
// The container of glTF binaries as meshhier writes them (docs/file_format.md, section 4.2).
import { HierarchyProblem } from './problem.js';

export interface Container {
  readonly document: unknown;
  /// The BIN chunk's data; null: there is no such chunk.
  readonly bin: Uint8Array | null;
}

const MAGIC = 0x46546c67; // "glTF"
const JSON_CHUNK = 0x4e4f534a;
const BIN_CHUNK = 0x004e4942;
const HEAD_BYTES = 20;
const CHUNK_HEAD_BYTES = 8;
const MOST_JSON_BYTES = 65536;

function parse(text: Uint8Array, name: string): unknown {
  try {
    return JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(text));
  } catch {
    throw new HierarchyProblem(name, 'its JSON chunk is not JSON');
  }
}

/// Throws HierarchyProblem unless the chunks fill the file exactly.
export function readContainer(bytes: Uint8Array, name: string): Container {
  const need = (good: boolean, problem: string): void => {
    if (!good) throw new HierarchyProblem(name, problem);
  };
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  need(bytes.byteLength >= HEAD_BYTES, 'is shorter than the head of a glTF binary');
  need(view.getUint32(0, true) === MAGIC && view.getUint32(4, true) === 2, 'is no glTF 2.0 binary');
  need(view.getUint32(8, true) === bytes.byteLength, 'has another length than it says');
  const jsonBytes = view.getUint32(12, true);
  const end = HEAD_BYTES + jsonBytes;
  const fits = jsonBytes % 4 === 0 && jsonBytes <= MOST_JSON_BYTES && end <= bytes.byteLength;
  need(fits && view.getUint32(16, true) === JSON_CHUNK, 'has no JSON chunk that fits');
  const document = parse(bytes.subarray(HEAD_BYTES, end), name);
  if (bytes.byteLength === end) return { document, bin: null };
  const begin = end + CHUNK_HEAD_BYTES;
  const isWhole = begin <= bytes.byteLength && view.getUint32(end, true) === bytes.byteLength - begin;
  need(isWhole && view.getUint32(end + 4, true) === BIN_CHUNK, 'has no BIN chunk that fits');
  return { document, bin: bytes.subarray(begin) };
}
