// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { stateText } from '../../page/gallery/job_cell.js';
import type { Job } from '../../page/listing.js';

function job(change: Partial<Job>): Job {
  return { name: 'a.ply', state: 'failed', stage: '', progress: null, secondsLeft: null, message: '', preview: null, ...change };
}

describe('what a job says', () => {
  it.each([
    ['a.ply: byte 7: expected a number', 'byte 7: expected a number'],
    ['b/a.ply: byte 7', 'b/a.ply: byte 7'],
    ['a.ply2 is missing', 'a.ply2 is missing'],
    ['a.ply:', 'failed, without saying why'],
    ['', 'failed, without saying why'],
  ])('of the failure "%s" is "%s"', (message, text) => { expect(stateText(job({ message }))).toBe(text); });

  it('is its stage, as far as that is known', () => {
    expect(stateText(job({ state: 'waiting' }))).toBe('waiting for its turn');
    expect(stateText(job({ state: 'building' }))).toBe('building');
    expect(stateText(job({ state: 'building', stage: 'simplify', progress: 0.5 }))).toBe('simplifying 50%');
    expect(stateText(job({ state: 'building', stage: 'toString', secondsLeft: 5 }))).toBe('toString, 5 sec left');
  });
});
