// SPDX-License-Identifier: MIT
import { expect, it } from 'vitest';
import { Taps } from '../src/taps.js';

const at = (pointerId: number, clientX: number, button = 0): { pointerId: number; clientX: number; clientY: number; button: number } =>
  ({ pointerId, clientX, clientY: 0, button });

it('takes for a tap what hardly moves', () => {
  const taps = new Taps();
  taps.down(at(1, 0));
  taps.move(at(1, 3));
  expect(taps.lift(at(1, 5))).toBe(true);
  expect(taps.lift(at(1, 5))).toBe(false);
  taps.down(at(1, 0, 2));
  expect(taps.lift(at(1, 0, 2))).toBe(false); // another button
});

it('takes a way there and back for a drag', () => {
  const taps = new Taps();
  taps.down(at(1, 0));
  for (const x of [40, 0]) taps.move(at(1, x));
  expect(taps.lift(at(1, 0))).toBe(false);
});

it('takes no finger of several for a tap', () => {
  const taps = new Taps();
  for (const pointer of [1, 2]) taps.down(at(pointer, 0));
  expect([taps.lift(at(1, 0)), taps.lift(at(2, 0))]).toEqual([false, false]);
  for (const pointer of [1, 2]) taps.down(at(pointer, 0));
  taps.cancel(at(1, 0));
  expect(taps.lift(at(2, 0))).toBe(false);
  taps.down(at(3, 0));
  expect(taps.lift(at(3, 0))).toBe(true);
});
