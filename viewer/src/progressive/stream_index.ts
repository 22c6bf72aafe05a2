// SPDX-License-Identifier: MIT
// progressive.json: what a progressive stream is made from, and its files (docs/file_format.md,
// section 7).
import { JsonValue, type Fail } from '../json_value.js';

export interface StreamFile {
  file: string;
  level: number;
  vertices: number;
  triangles: number;
  merges: number;
  shown_vertices: number;
  shown_triangles: number;
  bytes: number;
  /// XXH3-64.
  checksum: bigint;
}

export type ColourType = 'none' | 'u8' | 'u16' | 'f32';

export interface StreamAttributes {
  normals: boolean;
  colours: ColourType;
  alpha: boolean;
  texcoords: boolean;
}

export interface Bounds {
  min: [number, number, number];
  max: [number, number, number];
}

export interface StreamIndex {
  vertices: number;
  own_vertices: number;
  triangles: number;
  origin: [number, number, number];
  up: 'y' | 'z';
  licence: string;
  /// Bounds in input coordinates.
  source: { file_name: string; attributes: StreamAttributes; bounds: Bounds };
  files: StreamFile[];
}

const FORMAT = 'meshhier-progressive';
const VERSION = 2;
/// Bytes of each of the client's arrays, and of a file: 2 GiB, which some browsers do not exceed.
const MOST_BYTES = 2 ** 31 - 1;

/// Thrown for a file that does not belong to the stream, or is damaged. The message names it.
export class StreamError extends Error {}

function readFile(file: JsonValue): StreamFile {
  return {
    file: file.at('file').fileName(),
    level: file.at('level').count(),
    vertices: file.at('vertices').count(),
    triangles: file.at('triangles').count(),
    merges: file.at('merges').count(),
    shown_vertices: file.at('shown_vertices').count(),
    shown_triangles: file.at('shown_triangles').count(),
    bytes: file.at('bytes').count(0, MOST_BYTES),
    checksum: BigInt(`0x${file.at('checksum').checksum()}`),
  };
}

function readAttributes(attributes: JsonValue): StreamAttributes {
  return {
    normals: attributes.at('normals').flag(),
    colours: attributes.at('colours').oneOf('none', 'u8', 'u16', 'f32'),
    alpha: attributes.at('alpha').flag(),
    texcoords: attributes.at('texcoords').flag(),
  };
}

/// The index of a text. Throws StreamError.
export function parseStreamIndex(text: string, name: string): StreamIndex {
  const refuse: Fail = (what) => {
    throw new StreamError(`${name}: ${what}`);
  };
  const root = JsonValue.parse(text, refuse);
  root.at('format').oneOf(FORMAT);
  const version = root.at('format_version').number();
  if (version < VERSION) refuse(`format version ${version}, made by an older meshhier: make the stream again`);
  if (version !== VERSION) refuse(`format version is ${version}, expected ${VERSION}`);
  const files = root.at('files').items().map(readFile);
  if (files.length === 0) refuse('it has no files');
  const source = root.at('source');
  const attributes = readAttributes(source.at('attributes'));
  const vertices = root.at('vertices').count(1, Math.floor(MOST_BYTES / (4 * valueBytes(attributes).length)));
  return {
    vertices,
    own_vertices: root.at('own_vertices').count(0, vertices),
    triangles: root.at('triangles').count(0, Math.floor(MOST_BYTES / 12)),
    origin: root.at('origin').triple(),
    up: root.at('up').oneOf('y', 'z'),
    licence: root.at('licence').text(),
    source: {
      file_name: source.at('file_name').text(),
      attributes,
      bounds: { min: source.at('bounds').at('min').triple(), max: source.at('bounds').at('max').triple() },
    },
    files,
  };
}

/// Bytes that each value of a vertex is kept in: x, y, z, then the attributes.
export function valueBytes(attributes: StreamAttributes): number[] {
  const bytes = [4, 4, 4];
  if (attributes.normals) bytes.push(4, 4, 4);
  const colour = { none: 0, u8: 1, u16: 2, f32: 4 }[attributes.colours];
  if (colour > 0) for (let i = 0; i < (attributes.alpha ? 4 : 3); ++i) bytes.push(colour);
  if (attributes.texcoords) bytes.push(4, 4);
  return bytes;
}
