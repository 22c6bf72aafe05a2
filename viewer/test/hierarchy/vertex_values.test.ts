// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import type { Glb } from '../../src/hierarchy/glb.js';
import { readColours, type Accessor } from '../../src/hierarchy/vertex_values.js';

type Numbers = Uint8Array | Uint16Array | Float32Array;

const TYPES = new Map<unknown, number>([[Uint8Array, 5121], [Uint16Array, 5123], [Float32Array, 5126]]);

/// Colours of vertices with four channels, as a tile holds them.
function coloursOf(values: Numbers, areScreenValues: boolean): number[] {
  const glb = {
    section: () => new Uint8Array(values.buffer),
    fail: (what: string) => { throw new Error(what); },
  } as unknown as Glb;
  const accessor = { bufferView: 0, componentType: TYPES.get(values.constructor)!, type: 'VEC4' } as Accessor;
  return [...readColours(glb, accessor, values.length / 4, areScreenValues)];
}

function light(value: number): number {
  return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
}

describe('colours of a tile', () => {
  const bytes = Array.from({ length: 256 }, (_, i) => i);

  it.each<[string, (part: number) => number, (all: number[]) => Numbers]>([
    ['light of 16 bits', (part) => Math.round(65535 * part), (all) => Uint16Array.from(all)],
    ['light as floats', (part) => part, (all) => Float32Array.from(all)],
  ])('are values of a screen: of %s', (_, stored, array) => {
    const values = array(bytes.flatMap((byte) => [light(byte / 255), light((255 - byte) / 255), 0, byte / 255].map(stored)));
    expect(coloursOf(values, false)).toEqual(bytes.flatMap((byte) => [byte, 255 - byte, 0, byte]));
  });

  it('of light in 8 bits are the nearest values of a screen', () => {
    expect(coloursOf(Uint8Array.of(51, 13, 128, 51), false)).toEqual([124, 64, 188, 51]);
  });

  it('of tiles of version 3 are what is stored', () => {
    expect(coloursOf(Uint8Array.of(51, 13, 128, 7), true)).toEqual([51, 13, 128, 7]);
    expect(coloursOf(Uint16Array.of(65535, 257, 0, 514), true)).toEqual([255, 1, 0, 2]);
    expect(coloursOf(Float32Array.of(1, 0.2, -1, 7), true)).toEqual([255, 51, 0, 255]);
  });

  it('that are no colours do no harm', () => {
    expect(coloursOf(Float32Array.of(NaN, -1, 7, NaN), false)).toEqual([0, 0, 255, 0]);
  });
});
