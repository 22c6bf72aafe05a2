// SPDX-License-Identifier: MIT
// XXH3-64 against what libxxhash says.
import { describe, expect, it } from 'vitest';
import { checksum, digitsOf } from '../../src/hierarchy/checksum.js';

/// So many bytes, always the same.
function bytesOf(count: number): Uint8Array {
  let state = 1;
  return Uint8Array.from({ length: count }, () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state >>> 24;
  });
}

const KNOWN: readonly (readonly [number, string])[] = [
  [0, '2d06800538d394c2'], [1, '429e81bc6744101c'], [3, '32dbb5c7774cc94f'], [4, '65775238ca34c06f'], [8, '90b760c9d253d0ff'],
  [9, '15ae9f843bb50ea4'], [10, '5734067869cc9237'], [16, '372c92fa68129c98'], [17, 'b5d6b9c1898bd9d6'], [128, 'c59e505a97d029e0'],
  [129, 'f9e651a476d6d3ca'], [240, '967597e635f3c527'], [241, 'd6afac6f8fa85b01'], [1024, 'bb9f0c3761cdfd54'], [1025, '95edccc1adc4d895'],
  [1088, 'e8391a3978cbcf06'], [1089, 'b6e2a9bc2973e16a'], [2048, '278f7a6a39416b51'], [2049, '644272755e8980a0'], [100_003, '48ace114702c07a4'],
];

describe('checksum', () => {
  it.each(KNOWN)('of %i bytes', (count, sum) => {
    expect(digitsOf(checksum(bytesOf(count)))).toBe(sum);
  });

  it.each([1, 2, 3, 5])('is the same of bytes that begin %i behind others', (before) => {
    const all = new Uint8Array(before + 100_003);
    all.set(bytesOf(100_003), before);
    expect(digitsOf(checksum(all.subarray(before)))).toBe('48ace114702c07a4');
  });

  it('is another one if any bit is', () => {
    const bytes = bytesOf(5000);
    const sums = new Set([checksum(bytes)]);
    for (let bit = 0; bit < 8 * bytes.length; bit += 61) {
      bytes[bit >> 3] ^= 1 << (bit & 7);
      sums.add(checksum(bytes));
      bytes[bit >> 3] ^= 1 << (bit & 7);
    }
    expect(sums.size).toBe(1 + Math.ceil((8 * bytes.length) / 61));
  });
});
