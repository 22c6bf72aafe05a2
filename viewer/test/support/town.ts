// SPDX-License-Identifier: MIT
// A town whose houses are objects: its mesh, and a hierarchy of it that has them.
import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { checksum, digitsOf } from '../../src/hierarchy/checksum.js';
import { tableOfRows, type NewRow } from './object_table.js';

export const TOWN_PROPERTIES = [{ name: 'storeys', type: 'number' }, { name: 'school', type: 'boolean' }, { name: 'address', type: 'text' }, { name: 'built', type: 'date' }];
/// Squares that a face of a house has along each side.
const CUTS = 3;

interface Square { readonly corner: readonly number[]; readonly along: readonly number[]; readonly up: readonly number[] }

/// The faces of a box that stands on the ground, seen from outside.
function facesOf([x, y]: readonly [number, number], height: number): Square[] {
  return [
    { corner: [x, y, 0], along: [1, 0, 0], up: [0, 0, height] }, { corner: [x + 1, y, 0], along: [0, 1, 0], up: [0, 0, height] },
    { corner: [x + 1, y + 1, 0], along: [-1, 0, 0], up: [0, 0, height] }, { corner: [x, y + 1, 0], along: [0, -1, 0], up: [0, 0, height] },
    { corner: [x, y, height], along: [1, 0, 0], up: [0, 1, 0] },
  ];
}

export class Town {
  readonly rows: NewRow[] = [];
  private readonly vertices: string[] = [];
  private readonly faces: string[] = [];

  /// So many houses along each side, two units apart; object 0 is the ground, which has no name.
  constructor(readonly side: number) {
    const far = 2 * side;
    const [none] = [{ name: '', values: [null, null, null, null], box: { min: [-1, -1, 0] as const, max: [far, far, 0] as const }, triangles: 0, area: (far + 1) ** 2 }];
    this.rows.push(none);
    this.square({ corner: [-1, -1, 0], along: [far + 1, 0, 0], up: [0, far + 1, 0] }, 0);
    for (let i = 0; i < side; ++i) for (let k = 0; k < side; ++k) this.house(i, k);
  }

  /// Where the middle of a house's roof is.
  roof(object: number): [number, number, number] {
    const { min, max } = this.rows[object].box!;
    return [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, max[2]];
  }

  ply(): string {
    const header = `ply\nformat ascii 1.0\nelement vertex ${this.vertices.length}\nproperty float x\nproperty float y\nproperty float z\n`;
    return `${header}element face ${this.faces.length}\nproperty list uchar int vertex_indices\nproperty uint object\nend_header\n${[...this.vertices, ...this.faces].join('\n')}\n`;
  }

  /// Turns a hierarchy of the mesh, in which faces have a label, into one with objects.
  furnish(hierarchy: string): void {
    const file = path.join(hierarchy, 'hierarchy.json');
    const manifest = JSON.parse(readFileSync(file, 'utf8')) as { checksum?: string; source: { values: { kind: string }[] } };
    delete manifest.checksum;
    const { bytes, json } = tableOfRows(this.rows, TOWN_PROPERTIES);
    writeFileSync(path.join(hierarchy, 'objects.bin'), bytes);
    manifest.source.values[0].kind = 'object';
    const text = JSON.stringify({ ...manifest, format_version: 14, objects: json }, null, 2).replace(/\n}$/, ',\n  "checksum": "');
    const sealed = (digits: string): string => `${text}${digits}"\n}\n`;
    writeFileSync(file, sealed(digitsOf(checksum(new TextEncoder().encode(sealed('0'.repeat(16)))))));
  }

  private house(i: number, k: number): void {
    const object = this.rows.length;
    const storeys = 1 + ((7 * i + 3 * k) % 5);
    const [x, y, height] = [2 * i, 2 * k, storeys / 2];
    const number = String(k).padStart(2, '0');
    this.rows.push({
      name: `street ${String(i).padStart(2, '0')}/house ${number}`, values: [storeys, object % 10 === 0, `${number} Street ${i}, Old Town`, object % 4 === 0 ? null : `19${String(object % 100).padStart(2, '0')}-05-01`],
      box: { min: [x, y, 0], max: [x + 1, y + 1, height] }, triangles: 5 * 2 * CUTS ** 2, area: 1 + 4 * height,
    });
    for (const face of facesOf([x, y], height)) this.square(face, object);
  }

  private square({ corner, along, up }: Square, object: number): void {
    const first = this.vertices.length;
    for (let v = 0; v <= CUTS; ++v)
      for (let u = 0; u <= CUTS; ++u) this.vertices.push(corner.map((start, axis) => start + (along[axis] * u + up[axis] * v) / CUTS).join(' '));
    for (let v = 0; v < CUTS; ++v)
      for (let u = 0; u < CUTS; ++u) {
        const a = first + v * (CUTS + 1) + u;
        this.faces.push(`3 ${a} ${a + 1} ${a + CUTS + 2} ${object}`, `3 ${a} ${a + CUTS + 2} ${a + CUTS + 1} ${object}`);
      }
  }
}
