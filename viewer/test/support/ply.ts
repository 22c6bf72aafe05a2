// SPDX-License-Identifier: MIT
// A mesh as meshgen writes it: binary, little endian, coordinates in floats or doubles first, triangles behind.
import { readFileSync } from 'node:fs';

export interface PlyMesh {
  readonly positions: Float64Array;
  readonly corners: Uint32Array;
}

const WIDTHS: Record<string, number> = { float: 4, double: 8, uchar: 1, int: 4 };

export function readPly(file: string): PlyMesh {
  const bytes = readFileSync(file);
  const end = bytes.indexOf('end_header\n') + 'end_header\n'.length;
  const header = bytes.subarray(0, end).toString('latin1');
  const count = (element: string): number => Number(new RegExp(`element ${element} (\\d+)`).exec(header)![1]);
  const properties = [...header.split('element face')[0].matchAll(/property (\w+) \w+/g)].map((match) => match[1]);
  const stride = properties.reduce((sum, type) => sum + WIDTHS[type], 0);
  const view = new DataView(bytes.buffer, bytes.byteOffset + end);
  const read = (at: number): number => (properties[0] === 'double' ? view.getFloat64(at, true) : view.getFloat32(at, true));
  const vertices = count('vertex');
  const positions = Float64Array.from({ length: 3 * vertices }, (_, i) => read(Math.floor(i / 3) * stride + (i % 3) * WIDTHS[properties[0]]));
  const faces = vertices * stride;
  return { positions, corners: Uint32Array.from({ length: 3 * count('face') }, (_, i) => view.getUint32(faces + Math.floor(i / 3) * 13 + 1 + 4 * (i % 3), true)) };
}
