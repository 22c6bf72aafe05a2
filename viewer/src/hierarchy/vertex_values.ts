// SPDX-License-Identifier: MIT
// Reads what the vertices of a tile have (docs/file_format.md, section 4.3), as it is drawn.
import type { Glb, Gltf } from './glb.js';

export type Accessor = Gltf['accessors'][number];

/// x, y, z, 0 of each vertex: in parts of 127 if they come from the build, else of 32767.
export type Normals = Int8Array | Int16Array;

/// A copy, so that it is aligned and holds nothing else alive.
export function detached(bytes: Uint8Array): ArrayBuffer {
  return bytes.slice().buffer;
}

function floats(bytes: Uint8Array): Float32Array {
  return new Float32Array(detached(bytes));
}

function stepOf(node: Gltf['nodes'][number]): number {
  return node.matrix ? Math.hypot(node.matrix[0], node.matrix[1], node.matrix[2]) : (node.scale?.[0] ?? 1);
}

export function readPositions(glb: Glb, accessor: Accessor, vertices: number): Float32Array {
  if (accessor.componentType === 5126) return floats(glb.section(accessor.bufferView, 12 * vertices));
  if (accessor.componentType !== 5123) glb.fail('positions of an unknown type');
  const points = new Uint16Array(detached(glb.section(accessor.bufferView, 8 * vertices)));
  const step = stepOf(glb.gltf.nodes[0]);
  const positions = new Float32Array(3 * vertices);
  for (let v = 0; v < vertices; ++v)
    for (let axis = 0; axis < 3; ++axis) positions[3 * v + axis] = step * points[4 * v + axis];
  return positions;
}

const COLOUR_TYPES: Record<number, { bytes: number; most: number }> = {
  5121: { bytes: 1, most: 255 },
  5123: { bytes: 2, most: 65535 },
  5126: { bytes: 4, most: 1 },
};

let screenValues: Uint8Array | null = null;

/// Makes the table of screen values for light in parts of 65535 (IEC 61966-2-1, sRGB).
function valuesOfLight(): Uint8Array {
  screenValues ??= Uint8Array.from({ length: 65536 }, (_, i) => {
    const light = i / 65535;
    return Math.round(255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * light ** (1 / 2.4) - 0.055));
  });
  return screenValues;
}

/// r, g, b, a as a screen has them.
export function readColours(glb: Glb, accessor: Accessor, vertices: number, areScreenValues: boolean): Uint8Array {
  const type = COLOUR_TYPES[accessor.componentType];
  const width = accessor.type === 'VEC4' ? 4 : 3;
  if (type === undefined) glb.fail('colours of an unknown type');
  const stride = Math.ceil((width * type.bytes) / 4) * 4;
  const bytes = detached(glb.section(accessor.bufferView, stride * vertices));
  const values = type.bytes === 1 ? new Uint8Array(bytes) : type.bytes === 2 ? new Uint16Array(bytes) : new Float32Array(bytes);
  const colours = new Uint8ClampedArray(4 * vertices).fill(255);
  const ofLight = areScreenValues ? null : valuesOfLight();
  for (let v = 0; v < vertices; ++v) {
    for (let c = 0; c < width; ++c) {
      const part = values[(v * stride) / type.bytes + c] / type.most;
      colours[4 * v + c] = ofLight && c < 3 ? ofLight[Math.round(65535 * Math.min(Math.max(part, 0), 1))] : 255 * part;
    }
  }
  return new Uint8Array(colours.buffer);
}

/// Reads where vertices lie in the tile's picture: within it.
export function readTexcoords(glb: Glb, { bufferView, componentType, type }: Accessor, vertices: number): Float32Array {
  if (componentType !== 5126 || type !== 'VEC2') glb.fail('texture coordinates of an unknown type');
  const texcoords = floats(glb.section(bufferView, 8 * vertices));
  if (!texcoords.every((value) => value >= 0 && value <= 1)) glb.fail('a texture coordinate outside the picture');
  return texcoords;
}

/// Reads where vertices lie in the tile's normal map: numbers in parts of 65535.
export function readMapTexcoords(glb: Glb, { bufferView, componentType, type }: Accessor, vertices: number): Float32Array {
  if (componentType !== 5123 || type !== 'VEC2') glb.fail('texture coordinates of an unknown type');
  const numbers = new Uint16Array(detached(glb.section(bufferView, 4 * vertices)));
  return Float32Array.from(numbers, (number) => number / 65535);
}

/// x, y, z in parts of 127 of each vertex, then 127 or -127, as the bitangent is on the one side or the other.
export function readTangents(glb: Glb, { bufferView, componentType, type }: Accessor, vertices: number): Int8Array {
  if (componentType !== 5120 || type !== 'VEC4') glb.fail('tangents of an unknown type');
  return new Int8Array(detached(glb.section(bufferView, 4 * vertices)));
}

/// Bytes of what a build computed.
function codedNormals(glb: Glb, { bufferView, normalized, type }: Accessor, vertices: number): Int8Array {
  if (normalized !== true || type !== 'VEC3') glb.fail('normals of an unknown type');
  return new Int8Array(detached(glb.section(bufferView, 4 * vertices)));
}

/// Reads the input's own normals.
function givenNormals(glb: Glb, { bufferView }: Accessor, vertices: number): Int16Array {
  const given = floats(glb.section(bufferView, 12 * vertices));
  const normals = new Int16Array(4 * vertices);
  for (let v = 0; v < vertices; ++v)
    for (let axis = 0; axis < 3; ++axis) normals[4 * v + axis] = Math.max(-32767, Math.min(32767, Math.round(32767 * given[3 * v + axis])));
  return normals;
}

export function readNormals(glb: Glb, accessor: Accessor, vertices: number): Normals {
  if (accessor.componentType === 5120) return codedNormals(glb, accessor, vertices);
  if (accessor.componentType === 5126) return givenNormals(glb, accessor, vertices);
  return glb.fail('normals of an unknown type');
}
