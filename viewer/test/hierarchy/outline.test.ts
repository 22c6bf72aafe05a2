// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { readOutline } from '../../src/hierarchy/outline.js';
import { HierarchyProblem } from '../../src/hierarchy/problem.js';
import { outlineBytes, type OutlineParts } from './outline_bytes.js';

const CORNER: OutlineParts = { positions: [0, 0, 0, 1, 0, 0, 1, 2, 0], segments: [0, 1, 1, 2] };
const Z_UP = [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 5, 6, -7, 1];

describe('an outline', () => {
  it('gives its lines', () => {
    const outline = readOutline(outlineBytes(CORNER));
    expect([...outline.positions]).toEqual(CORNER.positions);
    expect([...outline.segments]).toEqual(CORNER.segments);
    expect(outline.up).toBe('y');
    expect(outline.matrix[0]).toBe(1);
  });

  it('tells how many of its last segments draw the form', () => {
    expect(readOutline(outlineBytes(CORNER)).formSegments).toBe(0);
    expect(readOutline(outlineBytes({ ...CORNER, formSegmentCount: 2 })).formSegments).toBe(2);
  });

  it('is read wherever its bytes lie in a buffer', () => {
    const bytes = outlineBytes(CORNER);
    const shifted = new Uint8Array(bytes.byteLength + 3);
    shifted.set(bytes, 3);
    expect([...readOutline(shifted.subarray(3)).segments]).toEqual(CORNER.segments);
  });

  it('tells which axis points up, and where its origin is', () => {
    const turned = readOutline(outlineBytes({ ...CORNER, node: { matrix: Z_UP } }));
    expect(turned.up).toBe('z');
    expect(turned.matrix).toEqual(Z_UP);
    const moved = readOutline(outlineBytes({ ...CORNER, node: { translation: [5, 6, 7] } }));
    expect(moved.up).toBe('y');
    expect(moved.matrix.slice(12)).toEqual([5, 6, 7, 1]);
  });

  it('may be empty', () => {
    const outline = readOutline(outlineBytes({}));
    expect(outline.positions.length + outline.segments.length).toBe(0);
  });

  it('has wide segments beyond 65535 vertices', () => {
    const positions = new Array<number>(3 * 65536).fill(0.5);
    const outline = readOutline(outlineBytes({ positions, segments: [0, 65535] }));
    expect(outline.segments).toBeInstanceOf(Uint32Array);
    expect([...outline.segments]).toEqual([0, 65535]);
  });
});

describe('bytes that are no outline', () => {
  const hostile: [string, OutlineParts][] = [
    ['another version', { ...CORNER, version: 2 }],
    ['more vertices than there are', { ...CORNER, vertexCount: 4 }],
    ['a count that is huge', { ...CORNER, vertexCount: 4294967295, segmentCount: 4294967295 }],
    ['a count that is no integer', { ...CORNER, vertexCount: 2.5 }],
    ['a negative count', { ...CORNER, segmentCount: -1 }],
    ['more segments than vertices', { ...CORNER, segmentCount: 4 }],
    ['more segments of the form than segments', { ...CORNER, formSegmentCount: 3 }],
    ['half a segment of the form', { ...CORNER, formSegmentCount: 0.5 }],
    ['vertices without segments', { ...CORNER, segmentCount: 0 }],
    ['a segment beyond the vertices', { ...CORNER, segments: [0, 1, 1, 3] }],
    ['a position that is no number', { ...CORNER, positions: [0, 0, NaN, 1, 0, 0, 1, 2, 0] }],
    ['a matrix of 15 numbers', { ...CORNER, node: { matrix: Z_UP.slice(1) } }],
    ['a matrix of texts', { ...CORNER, node: { matrix: Z_UP.map(String) } }],
    ['a translation that is none', { ...CORNER, node: { translation: 'up' } }],
    ['bytes after no lines', { ...CORNER, vertexCount: 0, segmentCount: 0 }],
  ];
  it.each(hostile)('%s is refused', (_, parts) => {
    expect(() => readOutline(outlineBytes(parts))).toThrow(HierarchyProblem);
  });

  it('are refused wherever the file is cut', () => {
    const bytes = outlineBytes(CORNER);
    for (let length = 0; length < bytes.byteLength; ++length)
      expect(() => readOutline(bytes.subarray(0, length))).toThrow(HierarchyProblem);
  });

  it('never do anything but be refused or read, whichever byte is wrong', () => {
    const bytes = outlineBytes(CORNER);
    for (let place = 0; place < bytes.byteLength; ++place) {
      const broken = bytes.slice();
      broken[place] ^= 0xa5;
      try {
        readOutline(broken);
      } catch (error) {
        expect(error).toBeInstanceOf(HierarchyProblem);
      }
    }
  });
});
