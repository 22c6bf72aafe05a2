// progressive.json: what a progressive stream is made from, and its files (docs/file_format.md,
// section 7).

export interface StreamFile {
  file: string;
  level: number;
  vertices: number;
  triangles: number;
  merges: number;
  shown_vertices: number;
  shown_triangles: number;
  bytes: number;
}

export type ColourType = 'none' | 'u8' | 'u16' | 'f32';

export interface Attributes {
  normals: boolean;
  colours: ColourType;
  alpha: boolean;
  texcoords: boolean;
}

export interface StreamIndex {
  vertices: number;
  own_vertices: number;
  triangles: number;
  origin: [number, number, number];
  up: 'y' | 'z';
  licence: string;
  source: { file_name: string; attributes: Attributes };
  files: StreamFile[];
}

const FORMAT = 'meshhier-progressive';
const VERSION = 1;

/// What does not belong to the stream, or is damaged. The message names the file.
export class StreamError extends Error {}

function isCount(value: unknown, most = Number.MAX_SAFE_INTEGER): value is number {
  return typeof value === 'number' && Number.isInteger(value) && value >= 0 && value <= most;
}

const COUNTS = ['level', 'vertices', 'triangles', 'merges', 'shown_vertices', 'shown_triangles', 'bytes'] as const;

/// The index of a text. Throws StreamError.
export function parseStreamIndex(text: string, name: string): StreamIndex {
  let document: any;
  try {
    document = JSON.parse(text);
  } catch {
    throw new StreamError(`${name}: is not JSON`);
  }
  if (document?.format !== FORMAT) throw new StreamError(`${name}: is no index of a progressive stream`);
  if (document.format_version !== VERSION)
    throw new StreamError(`${name}: format version is ${document.format_version}, expected ${VERSION}`);
  const sound =
    isCount(document.vertices, 2 ** 32 - 1) &&
    isCount(document.own_vertices, document.vertices) &&
    isCount(document.triangles, 2 ** 32 - 1) &&
    Array.isArray(document.origin) &&
    Array.isArray(document.files) &&
    document.files.length > 0 &&
    document.files.every((file: any) => typeof file?.file === 'string' && COUNTS.every((key) => isCount(file[key]))) &&
    ['none', 'u8', 'u16', 'f32'].includes(document.source?.attributes?.colours);
  if (!sound) throw new StreamError(`${name}: a count, the origin, the attributes or the files are wrong`);
  return document as StreamIndex;
}

/// Bytes that each value of a vertex is kept in: x, y, z, then the attributes.
export function valueBytes(attributes: Attributes): number[] {
  const bytes = [4, 4, 4];
  if (attributes.normals) bytes.push(4, 4, 4);
  const colour = { none: 0, u8: 1, u16: 2, f32: 4 }[attributes.colours];
  if (colour > 0) for (let i = 0; i < (attributes.alpha ? 4 : 3); ++i) bytes.push(colour);
  if (attributes.texcoords) bytes.push(4, 4);
  return bytes;
}
