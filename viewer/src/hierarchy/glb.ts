// SPDX-License-Identifier: MIT
// Tiles as glTF binaries (docs/file_format.md, sections 4.3, 4.4 and 4.8): the sections of the BIN chunk, out of their
// compression.
import { MeshoptDecoder } from 'meshoptimizer/decoder';
import { readContainer, type BufferView, type Compressed } from './glb_container.js';
import { HierarchyProblem } from './problem.js';

export interface Gltf {
  nodes: { matrix?: number[]; translation?: number[]; scale?: number[] }[];
  meshes: { primitives: { attributes: Record<string, number>; indices?: number; mode: number }[] }[];
  accessors: { bufferView: number; componentType: number; normalized?: boolean; count: number; type: string; min?: number[]; max?: number[] }[];
  bufferViews: BufferView[];
  /// A tile's picture and its normal map, if it has them.
  images?: { bufferView?: unknown; mimeType?: unknown }[];
  materials?: { alphaMode?: unknown; normalTexture?: { texCoord?: number }; extensions?: Record<string, unknown> }[];
  extensions: Record<string, Record<string, number>>;
  /// The root has them.
  extras?: unknown;
}

/// No codec of meshoptimizer makes more of a byte: a vertex's byte takes a quarter of a bit at least, with headers; three indices
/// take a byte, an index of a sequence too.
const MOST_EXPANSION: Readonly<Record<string, number>> = { ATTRIBUTES: 256, TRIANGLES: 12, INDICES: 4 };

export class Glb {
  private constructor(
    readonly gltf: Gltf,
    private readonly bin: Uint8Array,
    private readonly name: string,
  ) {}

  static read(bytes: Uint8Array, name: string): Glb {
    const { document, bin } = readContainer(bytes, name);
    return new Glb(document as Gltf, bin ?? new Uint8Array(0), name);
  }

  /// The bytes of a section that must have `length`; those of number -1 are none.
  section(number: number, length: number): Uint8Array {
    if (number === -1 && length === 0) return new Uint8Array(0);
    const view = this.gltf.bufferViews?.[number];
    if (view?.byteLength !== length) this.fail(`section ${number} has not the ${length} bytes that its counts say`);
    const compressed = view.extensions?.EXT_meshopt_compression;
    return compressed ? this.decompress(compressed, length) : this.slice(view.byteOffset ?? 0, length);
  }

  /// The bytes of a section that is a file of its own, however long.
  file(number: number): Uint8Array {
    const view = this.gltf.bufferViews?.[number];
    if (view === undefined || view.extensions?.EXT_meshopt_compression) this.fail(`section ${number} is no file`);
    return this.slice(view.byteOffset ?? 0, view.byteLength);
  }

  private decompress(of: Compressed, length: number): Uint8Array {
    const source = this.slice(of.byteOffset ?? 0, of.byteLength);
    const most = (MOST_EXPANSION[of.mode] ?? 0) * source.length;
    if (of.count * of.byteStride !== length || length > most) this.fail('a compressed section of another size');
    const target = new Uint8Array(length);
    try {
      MeshoptDecoder.decodeGltfBuffer(target, of.count, of.byteStride, source, of.mode, of.filter);
    } catch {
      this.fail('a compressed section is damaged');
    }
    return target;
  }

  private slice(offset: number, length: number): Uint8Array {
    const inside = Number.isInteger(offset) && Number.isInteger(length) && offset >= 0 && length >= 0;
    if (!inside || offset + length > this.bin.length) this.fail('a section lies outside the file');
    return this.bin.subarray(offset, offset + length);
  }

  fail(what: string): never {
    throw new HierarchyProblem(this.name, what);
  }
}
