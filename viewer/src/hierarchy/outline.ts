// SPDX-License-Identifier: MIT
// The shape-outline, outline.glb (docs/file_format.md, sections 4.2 and 5).
import { asObject, type Json } from '../json_value.js';
import { readFirstView, type FirstView } from './first_view.js';
import { readContainer } from './glb_container.js';
import { HierarchyProblem } from './problem.js';
import { checksum } from './checksum.js';
import type { Manifest } from './manifest.js';
import { whole, type RemoteFiles } from './files.js';

export interface Outline {
  /// Three numbers a vertex, relative to the hierarchy's origin.
  positions: Float32Array;
  /// Two vertices each, in the order of the vertices.
  segments: Uint16Array | Uint32Array;
  /// The last so many draw the form: creases, ridges and valleys. The others are borders, and where sectors meet.
  formSegments: number;
  /// The axis of the stored positions that points up.
  up: 'y' | 'z';
  /// Turns stored positions upright, and adds the origin until format version 11; 16 numbers, column by column.
  matrix: readonly number[];
  firstView: FirstView | null;
}

const FILE = 'outline.glb';
const MOST_BYTES = 2 ** 20;
const MOST_SHORT_VERTICES = 65535;
const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

interface OutlineCounts {
  vertices: number;
  segments: number;
  formSegments: number;
}

function need(good: boolean, problem: string): asserts good {
  if (!good) throw new HierarchyProblem(FILE, problem);
}

function isCount(value: unknown): value is number {
  return typeof value === 'number' && Number.isInteger(value) && value >= 0 && value < 2 ** 32;
}

function readCounts(document: Json): OutlineCounts {
  const extension = asObject(asObject(document.extensions).MESHHIER_outline);
  need(extension.version === 1, 'is no outline of version 1');
  const { vertexCount, segmentCount, formSegmentCount = 0 } = extension;
  need(isCount(vertexCount) && isCount(segmentCount) && isCount(formSegmentCount), 'its counts are no counts');
  need(segmentCount <= vertexCount && (segmentCount > 0 || vertexCount === 0) && formSegmentCount <= segmentCount, 'its counts cannot be');
  return { vertices: vertexCount, segments: segmentCount, formSegments: formSegmentCount };
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

function readLines(bin: Uint8Array | null, { vertices, segments }: OutlineCounts): Pick<Outline, 'positions' | 'segments'> {
  const short = vertices <= MOST_SHORT_VERTICES;
  need(bin?.byteLength === 12 * vertices + (short ? 4 : 8) * segments, 'has another length than its counts ask for');
  const buffer = bin.slice().buffer;
  const positions = new Float32Array(buffer, 0, 3 * vertices);
  const corners = new (short ? Uint16Array : Uint32Array)(buffer, 12 * vertices, 2 * segments);
  need(positions.every(Number.isFinite), 'has a position that is not finite');
  need(corners.every((corner) => corner < vertices), 'has a segment of a vertex that is not there');
  return { positions, segments: corners };
}

/// Reads the outline in a file's bytes. Throws HierarchyProblem for what is none.
export function readOutline(bytes: Uint8Array): Outline {
  const { document, bin } = readContainer(bytes, FILE);
  const root = asObject(document);
  const counts = readCounts(root);
  const matrix = readMatrix(root);
  const up = upOf(matrix);
  const firstView = readFirstView(root, () => { throw new HierarchyProblem(FILE, 'its first view is none'); });
  const { formSegments } = counts;
  if (counts.segments > 0) return { ...readLines(bin, counts), formSegments, up, matrix, firstView };
  need(bin === null, 'has bytes after an outline without lines');
  return { positions: new Float32Array(), segments: new Uint16Array(), formSegments, up, matrix, firstView };
}

/// The one that the manifest tells of. Throws as fetchOutline().
export async function fetchOutlineOf({ outline: { checksum: sum } }: Manifest, files: RemoteFiles, signal: AbortSignal): Promise<Outline> {
  const bytes = await whole(files, FILE, MOST_BYTES, { signal });
  need(checksum(bytes) === sum || (files.holds?.(FILE) ?? false), 'its checksum is not that of the manifest: it is damaged, or of another build');
  return readOutline(bytes);
}

/// Whichever is there. Throws HierarchyProblem, and what ends `signal`.
export async function fetchOutline(files: RemoteFiles, signal: AbortSignal): Promise<Outline> {
  return readOutline(await whole(files, FILE, MOST_BYTES, { signal }));
}
