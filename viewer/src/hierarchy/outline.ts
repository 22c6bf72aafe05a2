// The shape-outline, outline.glb (docs/file_format.md, sections 4.2 and 5).
import { HierarchyProblem } from './problem.js';

export interface Outline {
  /// Three numbers a vertex, relative to the hierarchy's origin.
  positions: Float32Array;
  /// Two vertices each, in the order of the vertices.
  segments: Uint16Array | Uint32Array;
  /// The axis of the stored positions that points up.
  up: 'y' | 'z';
  /// Turns stored positions upright and adds the origin; 16 numbers, column by column.
  matrix: readonly number[];
}

const FILE = 'outline.glb';
const MAGIC = 0x46546c67; // "glTF"
const JSON_CHUNK = 0x4e4f534a;
const BIN_CHUNK = 0x004e4942;
const HEAD_BYTES = 20;
const MOST_JSON_BYTES = 65536;
const MOST_SHORT_VERTICES = 65535;
const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

interface Counts {
  vertices: number;
  segments: number;
}

type Json = Record<string, unknown>;

function need(good: boolean, problem: string): asserts good {
  if (!good) throw new HierarchyProblem(FILE, problem);
}

function viewOf(bytes: Uint8Array): DataView {
  return new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
}

/// Bytes of the JSON chunk's data.
function jsonLength(bytes: Uint8Array): number {
  need(bytes.byteLength >= HEAD_BYTES, 'is shorter than the head of a glTF binary');
  const view = viewOf(bytes);
  need(view.getUint32(0, true) === MAGIC && view.getUint32(4, true) === 2, 'is no glTF 2.0 binary');
  need(view.getUint32(8, true) === bytes.byteLength, 'has another length than it says');
  const length = view.getUint32(12, true);
  const fits = length % 4 === 0 && length <= MOST_JSON_BYTES && length <= bytes.byteLength - HEAD_BYTES;
  need(fits && view.getUint32(16, true) === JSON_CHUNK, 'has no JSON chunk that fits');
  return length;
}

function parseJson(bytes: Uint8Array): unknown {
  try {
    return JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(bytes));
  } catch {
    throw new HierarchyProblem(FILE, 'its JSON chunk is not JSON');
  }
}

function asObject(value: unknown): Json {
  return typeof value === 'object' && value !== null ? (value as Json) : {};
}

function isCount(value: unknown): value is number {
  return typeof value === 'number' && Number.isInteger(value) && value >= 0 && value < 2 ** 32;
}

function readCounts(document: Json): Counts {
  const extension = asObject(asObject(document.extensions).MESHHIER_outline);
  need(extension.version === 1, 'is no outline of version 1');
  const { vertexCount, segmentCount } = extension;
  need(isCount(vertexCount) && isCount(segmentCount), 'its counts are no counts');
  need(segmentCount <= vertexCount && (segmentCount > 0 || vertexCount === 0), 'its counts cannot be');
  return { vertices: vertexCount, segments: segmentCount };
}

function numbers(value: unknown, count: number): number[] | null {
  if (!Array.isArray(value) || value.length !== count) return null;
  return value.every((item) => typeof item === 'number' && Number.isFinite(item)) ? (value as number[]) : null;
}

/// The node's matrix; a node without one may have a translation.
function readMatrix(document: Json): number[] {
  const node = asObject(Array.isArray(document.nodes) ? document.nodes[0] : null);
  if (node.matrix !== undefined) {
    const matrix = numbers(node.matrix, 16);
    need(matrix !== null, 'its matrix is not 16 numbers');
    return matrix;
  }
  if (node.translation === undefined) return IDENTITY;
  const translation = numbers(node.translation, 3);
  need(translation !== null, 'its translation is not three numbers');
  return [...IDENTITY.slice(0, 12), ...translation, 1];
}

/// (x, y, z) to (x, z, -y).
function upOf(matrix: readonly number[]): 'y' | 'z' {
  return matrix[6] === -1 && matrix[9] === 1 ? 'z' : 'y';
}

/// The BIN chunk's data, of exactly the length that the counts ask for, at the start of its own buffer.
function readBin(bytes: Uint8Array, start: number, length: number): ArrayBuffer {
  need(bytes.byteLength === start + 8 + length, 'has another length than its counts ask for');
  const view = viewOf(bytes);
  const good = view.getUint32(start, true) === length && view.getUint32(start + 4, true) === BIN_CHUNK;
  need(good, 'has no BIN chunk that fits');
  return bytes.slice(start + 8).buffer;
}

function readLines(bytes: Uint8Array, start: number, { vertices, segments }: Counts): Pick<Outline, 'positions' | 'segments'> {
  const short = vertices <= MOST_SHORT_VERTICES;
  const buffer = readBin(bytes, start, 12 * vertices + (short ? 4 : 8) * segments);
  const positions = new Float32Array(buffer, 0, 3 * vertices);
  const corners = new (short ? Uint16Array : Uint32Array)(buffer, 12 * vertices, 2 * segments);
  need(positions.every(Number.isFinite), 'has a position that is not finite');
  need(corners.every((corner) => corner < vertices), 'has a segment of a vertex that is not there');
  return { positions, segments: corners };
}

/// The outline in a file's bytes. Throws HierarchyProblem.
export function readOutline(bytes: Uint8Array): Outline {
  const length = jsonLength(bytes);
  const document = asObject(parseJson(bytes.subarray(HEAD_BYTES, HEAD_BYTES + length)));
  const counts = readCounts(document);
  const start = HEAD_BYTES + length;
  const matrix = readMatrix(document);
  const up = upOf(matrix);
  if (counts.segments > 0) return { ...readLines(bytes, start, counts), up, matrix };
  need(bytes.byteLength === start, 'has bytes after an outline without lines');
  return { positions: new Float32Array(), segments: new Uint16Array(), up, matrix };
}
