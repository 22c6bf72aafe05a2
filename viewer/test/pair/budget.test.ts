// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { PairBudget, split, type Both } from '../../src/pair/budget.js';
import type { Stats } from '../../src/scene/settings.js';

const enough = (amount: number, share: number) => ({ amount, share, isHungry: false });
const hungry = (amount: number, share: number) => ({ amount, share, isHungry: true });

describe('two shares', () => {
  it('are halves where both want more', () => {
    expect(split(100, [hungry(50, 50), hungry(40, 50)])).toEqual([50, 50]);
  });

  it('are halves where both have enough', () => {
    expect(split(100, [enough(10, 50), enough(20, 50)])).toEqual([50, 50]);
  });

  it('give one that wants more what the other one does not take', () => {
    const [small, large] = split(100, [enough(10, 50), hungry(50, 50)]);
    expect([small, large].map(Math.round)).toEqual([11, 89]);
  });

  it('leave one that has more than its half, as long as the other one has enough', () => {
    expect(split(100, [enough(75, 89), enough(10, 11)]).map(Math.round)).toEqual([89, 11]);
  });

  it('come to rest, whoever grows', () => {
    let shares: Both<number> = [89, 11];
    for (let frame = 0; frame < 10; ++frame) shares = split(100, [hungry(shares[0], shares[0]), hungry(shares[1], shares[1])]);
    expect(shares).toEqual([50, 50]);
  });

  it('always add up', () => {
    for (let amount = 0; amount <= 100; amount += 7)
      for (const make of [enough, hungry]) {
        const [one, other] = split(100, [make(amount, amount), enough(100 - amount, 50)]);
        expect(one + other).toBeCloseTo(100, 10);
        expect(Math.min(one, other)).toBeGreaterThanOrEqual(2);
      }
  });
});

function statsOf(change: Partial<Stats>): Stats {
  return { moving: false, vertices: 0, residentBytes: 0, wantedBytes: 0, limited: { vertices: false, bytes: false }, ...change } as Stats;
}

describe('a budget of two views', () => {
  it('lets none take what the other one has still to give up', () => {
    const budget = new PairBudget(30);
    const shares = budget.take([statsOf({ residentBytes: 900, wantedBytes: 950, limited: { vertices: false, bytes: true } }), statsOf({ residentBytes: 50, wantedBytes: 60, limited: { vertices: false, bytes: true } })], 1000, 0);
    expect(shares[1].bytes).toBeLessThanOrEqual(100);
    expect(900 + shares[1].bytes).toBeLessThanOrEqual(1000);
    expect(shares[0].bytes).toBe(500);
  });

  it('counts the vertices of both against one frame rate', () => {
    const budget = new PairBudget(30);
    let now = 0;
    const moving = statsOf({ moving: true, vertices: 500_000, limited: { vertices: true, bytes: false } });
    const before = budget.rate.budget;
    for (let frame = 0; frame < 12; ++frame) budget.take([moving, moving], 1000, (now += 100)); // 10 frames a second
    expect(budget.rate.budget).toBeLessThan(before / 2);
    const [one, other] = budget.take([moving, moving], 1000, (now += 100));
    expect(one.vertices + other.vertices).toBeLessThanOrEqual(budget.rate.budget + 1);
  });

  it('is uneasy until shares fit what is needed', () => {
    const budget = new PairBudget(30);
    const stats = [statsOf({ residentBytes: 10, wantedBytes: 10 }), statsOf({ residentBytes: 400, wantedBytes: 450, limited: { vertices: false, bytes: true } })] as const;
    expect(budget.isUneasy(stats, 1000)).toBe(true);
    budget.take(stats, 1000, 0);
    expect(budget.isUneasy(stats, 1000)).toBe(false);
  });
});
