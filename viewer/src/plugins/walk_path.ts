// SPDX-License-Identifier: MIT
// A way on foot from one place to another, and where one is on it in time.
import type { WalkSpace } from '../tools/walk_space.js';
import type { Feet, Walker } from '../tools/walker.js';

const SPEED = 3; // eye heights a second
const SECONDS = { least: 0.35, most: 1.6 };
const MOST_STEPS = 2000;

function apart(a: Feet, b: Feet): number {
  return Math.hypot(b.x - a.x, b.y - a.y, b.z - a.z);
}

/// Walks from one place towards another, as far as that comes nearer. Falls are taken at once.
export function walkTowards(walker: Walker, spaceAt: (feet: Feet) => WalkSpace, from: Feet, to: Feet): Feet[] {
  const way = [from];
  const left = ({ x, z }: Feet): number => Math.hypot(to.x - x, to.z - z);
  const { radius } = walker.body;
  for (let now = from; left(now) > 1e-3 * radius && way.length < MOST_STEPS; now = way[way.length - 1]) {
    const part = Math.min(1, radius / (2 * left(now)));
    const space = spaceAt(now);
    const moved = walker.move(space, now, { x: (to.x - now.x) * part, z: (to.z - now.z) * part });
    const next = walker.fall(space, moved, 100, 1);
    if (!(left(next) < left(now) - 1e-2 * radius) && left(next) > 1e-3 * radius) break;
    way.push(next);
  }
  return way;
}

export class WalkPath {
  private readonly lengths: number[] = [0];
  private readonly seconds: number;

  /// Two places or more.
  constructor(private readonly way: readonly Feet[], eyeHeight: number) {
    for (let i = 1; i < way.length; ++i) this.lengths.push(this.lengths[i - 1] + apart(way[i - 1], way[i]));
    this.seconds = Math.min(Math.max(this.length / (SPEED * eyeHeight), SECONDS.least), SECONDS.most);
  }

  get end(): Feet {
    return this.way[this.way.length - 1];
  }

  /// Null: it is at its end.
  at(seconds: number): Feet | null {
    const t = seconds / this.seconds;
    if (t >= 1) return null;
    const along = this.length * t * t * (3 - 2 * t);
    const next = Math.max(1, this.lengths.findIndex((each) => each >= along));
    const [a, b] = [this.way[next - 1], this.way[next]];
    const part = (along - this.lengths[next - 1]) / (this.lengths[next] - this.lengths[next - 1] || 1);
    return { x: a.x + part * (b.x - a.x), y: a.y + part * (b.y - a.y), z: a.z + part * (b.z - a.z) };
  }

  private get length(): number {
    return this.lengths[this.lengths.length - 1];
  }
}
