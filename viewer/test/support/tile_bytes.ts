// SPDX-License-Identifier: MIT
// Tiles as bytes (docs/file_format.md, section 4), made by hand.
import { MeshoptEncoder } from 'meshoptimizer/encoder';

export interface PictureParts {
  readonly file: Uint8Array;
  readonly mimeType: string;
  readonly width: number;
  readonly height: number;
  readonly alphaMode?: string;
  readonly unlit?: boolean;
}

export interface TileParts {
  readonly own: number;
  readonly ghosts?: number;
  /// x, y, z of each vertex.
  readonly positions: readonly number[];
  /// The input's, x, y, z of each vertex.
  readonly normals?: readonly number[];
  /// Computed ones, in parts of 127; and what is different in their accessor.
  readonly codes?: readonly number[];
  readonly codeAccessor?: object;
  /// r, g, b, a of each vertex.
  readonly colours?: readonly number[];
  readonly coloursTint?: boolean;
  /// u, v of each vertex, and what they are in.
  readonly texcoords?: readonly number[] | Float32Array | null;
  readonly picture?: PictureParts;
  /// Instead: then coordinates are stored in parts of 65535; or beside it. And tangents, in parts of 127.
  readonly normalMap?: PictureParts;
  readonly tangents?: readonly number[];
  readonly interior: readonly number[];
  readonly border?: readonly number[];
  readonly copyOf?: readonly number[];
  readonly splitOf?: readonly number[];
  readonly level?: number;
  readonly index?: number;
  readonly neighbours?: readonly number[];
  readonly ghostStarts?: readonly number[];
  readonly chains?: readonly number[];
}

/// How a section is compressed, if it is.
interface Packing {
  readonly stride: number;
  readonly mode: 'ATTRIBUTES' | 'INDICES';
}

/// x, y, z, 0 of each.
function coded(codes: readonly number[]): Int8Array {
  return Int8Array.from({ length: (4 * codes.length) / 3 }, (_, i) => (i % 4 === 3 ? 0 : codes[3 * (i >> 2) + (i % 4)]));
}

function pack(bytes: Uint8Array, { stride, mode }: Packing): { packed: Uint8Array; compression: object } {
  const count = bytes.length / stride;
  const packed = MeshoptEncoder.encodeGltfBuffer(bytes, count, stride, mode);
  return { packed, compression: { buffer: 0, byteLength: packed.length, byteStride: stride, count, mode } };
}

/// glTF binary; `change`: what is different in MESHHIER_tile.
export function tileBytes(parts: TileParts, change: Record<string, number> = {}): Uint8Array {
  return written(parts, change, false);
}

/// The same, compressed: all but triangles and neighbours.
export async function packedTileBytes(parts: TileParts): Promise<Uint8Array> {
  await MeshoptEncoder.ready;
  return written(parts, {}, true);
}

function written(parts: TileParts, change: Record<string, number>, isPacked: boolean): Uint8Array {
  const { own, ghosts = 0, positions, normals, codes, colours, interior, border = [] } = parts;
  const { copyOf = [], splitOf = [], neighbours = [], ghostStarts = [], chains = [] } = parts;
  const chunks: Uint8Array[] = [];
  const bufferViews: object[] = [];
  let end = 0;
  const store = (bytes: Uint8Array): number => {
    const begin = end;
    chunks.push(bytes, new Uint8Array(-bytes.length & 3));
    end += bytes.length + (-bytes.length & 3);
    return begin;
  };
  const section = (values: ArrayBufferView, packing: Packing | null = null): number => {
    if (values.byteLength === 0) return -1;
    const bytes = new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
    const byteLength = bytes.length;
    if (!isPacked || packing === null) return bufferViews.push({ byteOffset: store(bytes), byteLength }) - 1;
    const { packed, compression } = pack(bytes, packing);
    return bufferViews.push({ byteLength, extensions: { EXT_meshopt_compression: { ...compression, byteOffset: store(packed) } } }) - 1;
  };
  const vertices = positions.length / 3;
  const accessors: object[] = [];
  const attributes: Record<string, number> = {};
  const attribute = (name: string, values: ArrayBufferView, rest: object): void => {
    const stride = values.byteLength / vertices;
    const packing = Number.isInteger(stride) ? { stride, mode: 'ATTRIBUTES' as const } : null;
    attributes[name] = accessors.push({ bufferView: section(values, packing), count: vertices, ...rest }) - 1;
  };
  attribute('POSITION', Float32Array.from(positions), { componentType: 5126, type: 'VEC3' });
  if (normals) attribute('NORMAL', Float32Array.from(normals), { componentType: 5126, type: 'VEC3' });
  if (codes) attribute('NORMAL', coded(codes), { componentType: 5120, normalized: true, type: 'VEC3', ...parts.codeAccessor });
  if (colours) attribute(parts.picture && !parts.coloursTint ? '_COLOR_0' : 'COLOR_0', Uint8Array.from(colours), { componentType: 5121, normalized: true, type: 'VEC4' });
  if (parts.tangents) attribute('TANGENT', Int8Array.from(parts.tangents), { componentType: 5120, normalized: true, type: 'VEC4' });
  if (parts.texcoords && parts.normalMap && !parts.picture) attribute('TEXCOORD_0', Uint16Array.from(parts.texcoords, (part) => Math.round(65535 * part)), { componentType: 5123, normalized: true, type: 'VEC2' });
  else if (parts.texcoords) attribute('TEXCOORD_0', Float32Array.from(parts.texcoords), { componentType: 5126, type: 'VEC2' });
  const numbers = (values: readonly number[]): number => section(Uint16Array.from(values), { stride: 2, mode: 'INDICES' });
  const primitives: object[] = [];
  const primitive = (corners: readonly number[]): number => {
    if (corners.length === 0) return -1;
    const indices = accessors.push({ bufferView: section(Uint16Array.from(corners)), componentType: 5123, count: corners.length, type: 'SCALAR' }) - 1;
    return primitives.push({ attributes, indices, mode: 4 }) - 1;
  };
  const extension = {
    version: parts.normalMap ? 6 : 3, level: parts.level ?? 0, index: parts.index ?? 0, ownCount: own, rimCount: own, ghostCount: ghosts, copyCount: copyOf.length, splitCount: splitOf.length,
    neighbourCount: neighbours.length, chainEntryCount: chains.length, interiorCount: interior.length / 3, borderCount: border.length / 3,
    interiorPrimitive: primitive(interior), borderPrimitive: primitive(border), neighbours: section(Uint32Array.from(neighbours)),
    ghostStarts: section(Uint32Array.from(ghostStarts)), ghostChains: numbers(chains), copyOf: numbers(copyOf), splitOf: numbers(splitOf),
    ...pictured(parts.picture, section), ...mapped(parts.normalMap, section),
  };
  const images = [[parts.picture, extension.image], [parts.normalMap, extension.normalMap]] as const;
  const text = JSON.stringify({ nodes: [{}], meshes: [{ primitives }], ...imagesOf(images), ...materialOf(parts.picture), accessors, bufferViews, extensions: { MESHHIER_tile: { ...extension, ...change } } });
  return container(text.padEnd(Math.ceil(text.length / 4) * 4), chunks, end);
}

function pictured(picture: PictureParts | undefined, section: (bytes: Uint8Array) => number): { image?: number; imageWidth?: number; imageHeight?: number } {
  return picture ? { imageWidth: picture.width, imageHeight: picture.height, image: section(picture.file) } : {};
}

function mapped(map: PictureParts | undefined, section: (bytes: Uint8Array) => number): { normalMap?: number; normalMapWidth?: number; normalMapHeight?: number } {
  return map ? { normalMapWidth: map.width, normalMapHeight: map.height, normalMap: section(map.file) } : {};
}

function imagesOf(images: readonly (readonly [PictureParts | undefined, number | undefined])[]): object {
  return { images: images.flatMap(([picture, bufferView]) => (picture ? [{ bufferView, mimeType: picture.mimeType }] : [])) };
}

function materialOf(picture: PictureParts | undefined): object {
  if (picture === undefined) return {};
  const { alphaMode, unlit } = picture;
  return { materials: [{ alphaMode, ...(unlit ? { extensions: { KHR_materials_unlit: {} } } : {}) }] };
}

function container(text: string, chunks: readonly Uint8Array[], binBytes: number): Uint8Array {
  const bytes = new Uint8Array(28 + text.length + binBytes);
  const view = new DataView(bytes.buffer);
  [0x46546c67, 2, bytes.length, text.length, 0x4e4f534a].forEach((word, i) => {
    view.setUint32(4 * i, word, true);
  });
  bytes.set(new TextEncoder().encode(text), 20);
  view.setUint32(20 + text.length, binBytes, true);
  view.setUint32(24 + text.length, 0x004e4942, true);
  let at = 28 + text.length;
  for (const chunk of chunks) {
    bytes.set(chunk, at);
    at += chunk.length;
  }
  return bytes;
}
