// SPDX-License-Identifier: MIT
// One budget for two views: of bytes in memory, and of vertices while the camera moves.
//
// Problem: two views that each hold a frame rate and a memory of their own take twice what was asked for, and two controllers that
// watch the same frames work against each other.
//
// Idea: one frame rate is measured over what both draw. A view that has enough gets what it takes and a little more; the other one
// gets the rest, and where both would take more than there is, each gets a half:
//
//      0                    half                    all
//      |- has enough, +10 % -|-- wants more --------->|
//      |- wants more ------->|<------- wants more ----|
//
// Invariant: shares add up to the budget; and no view may take on what the other one has still to give up, so that what both hold
// never adds up to more.
import { FrameRate } from '../cut/frame_rate.js';
import type { Stats } from '../scene/settings.js';
import type { Share } from '../scene/share.js';

export type Both<T> = readonly [T, T];

export interface Need {
  /// Taken now.
  readonly amount: number;
  /// Allowed now.
  readonly share: number;
  /// More would be taken if more were allowed.
  readonly isHungry: boolean;
}

/// A view that has enough may grow by so much before it is short.
const SPARE = 1.1;
/// One that is short is given so many times as much, until it has enough or its half.
const GROWTH = 2;
/// No view gets less than this part: it has to begin with something.
const LEAST = 0.02;
/// A view is not bothered for less: no flicker.
const WORTH_IT = 0.01;
const LONGEST_FRAME_MS = 5000; // a longer one was no frame: the page slept

function demandOf({ amount, share, isHungry }: Need): number {
  return isHungry ? Math.max(amount, share) * GROWTH : amount * SPARE;
}

/// Shares that add up to `all`.
export function split(all: number, needs: Both<Need>): Both<number> {
  const [one, other] = needs.map((need) => Math.max(demandOf(need), LEAST * all));
  const half = all / 2;
  if (one < half && other >= half) return [one, all - one];
  if (other < half && one >= half) return [all - other, other];
  return [half, half];
}

/// Each share, less what the other view holds above its own.
function safe(all: number, shares: Both<number>, held: Both<number>): Both<number> {
  const may = (own: number, others: number, othersHold: number): number => Math.max(0, Math.min(own, all - Math.max(others, othersHold)));
  return [may(shares[0], shares[1], held[1]), may(shares[1], shares[0], held[0])];
}

export class PairBudget {
  readonly rate: FrameRate;
  /// The most bytes that both ever held together.
  peakBytes = 0;
  private bytes: Both<number> = [0.5, 0.5]; // parts of the budget
  private vertices: Both<number> = [0.5, 0.5];
  private given: Both<Share> | null = null;
  private wasMoving = false;
  private lastFrame = 0;

  constructor(framesPerSecond: number) {
    this.rate = new FrameRate(framesPerSecond);
  }

  /// The shares of a frame that begins. `stats`: of both views, of the frame before; `all`: bytes.
  take(stats: Both<Stats>, all: number, now: number): Both<Share> {
    this.measure(stats, now);
    const [a, b] = stats;
    const held = [a.residentBytes, b.residentBytes] as const;
    this.peakBytes = Math.max(this.peakBytes, held[0] + held[1]);
    if (a.moving || b.moving) this.vertices = this.parts(stats, this.vertices, this.rate.budget, ({ vertices }) => vertices, 'vertices');
    this.bytes = this.parts(stats, this.bytes, all, ({ wantedBytes }) => wantedBytes, 'bytes');
    const bytes = safe(all, [this.bytes[0] * all, this.bytes[1] * all], held);
    this.given = [0, 1].map((i) => ({ vertices: Math.round(this.vertices[i] * this.rate.budget), bytes: bytes[i] })) as unknown as Both<Share>;
    return this.given;
  }

  /// Tells whether a view is to get another share in the next frame than in the last one.
  isUneasy(stats: Both<Stats>, all: number): boolean {
    const { given } = this;
    if (given === null) return true;
    const next = this.parts(stats, this.bytes, all, ({ wantedBytes }) => wantedBytes, 'bytes');
    const bytes = safe(all, [next[0] * all, next[1] * all], [stats[0].residentBytes, stats[1].residentBytes]);
    return bytes.some((each, i) => Math.abs(each - given[i].bytes) > WORTH_IT * all);
  }

  /// The last parts, unless the next ones are worth it.
  private parts(stats: Both<Stats>, last: Both<number>, all: number, amountOf: (stats: Stats) => number, what: 'vertices' | 'bytes'): Both<number> {
    const need = (i: 0 | 1): Need => ({ amount: amountOf(stats[i]), share: last[i] * all, isHungry: stats[i].limited[what] });
    const [one, other] = split(all, [need(0), need(1)]);
    return Math.abs(one / all - last[0]) > WORTH_IT ? [one / all, other / all] : last;
  }

  private measure([a, b]: Both<Stats>, now: number): void {
    const interval = now - this.lastFrame;
    this.lastFrame = now;
    const isMoving = a.moving || b.moving;
    if (isMoving && !this.wasMoving) this.rate.restart();
    else if (isMoving && interval < LONGEST_FRAME_MS) this.rate.frame(interval, a.vertices + b.vertices, a.limited.vertices || b.limited.vertices);
    this.wasMoving = isMoving;
  }
}
