// SPDX-License-Identifier: MIT
// Problem: somebody walks among triangles, never through a wall, up stairs, and never below the floor.
// Idea: a disk in plan, from knees to head, is moved by small steps. What it overlaps pushes it out, which lets it slide along walls. A step that
// would still pass a wall, squeeze into a gap, hit the head or lead to where there is no ground is not taken.
//
//        wall |  .-.
//             | ( o )-->   the step      |.-.
//             |  '-'                     ( o )  pushed out: along the wall
//
// Invariant: the way of the disk's middle passes no side of what stands in the way; the feet are on the ground or fall, and never below it.
// Cost: a few questions of the space for each third of a radius.
import { nearestOf, passes, type Plan, type Polygon, type WalkSpace } from './walk_space.js';

/// In units of the world.
export interface Body {
  readonly radius: number;
  /// What is lower is stepped upon.
  readonly step: number;
  /// The head ends here, above the feet.
  readonly height: number;
}

/// Where the feet are; y is up.
export interface Feet extends Plan {
  readonly y: number;
}

const PUSHES = 6;
const PART = 1 / 3; // of a radius: a step
const SLACK = 1e-3; // of a radius
/// Parts of a radius around the middle, on which one may stand where there is nothing below the middle, or hover over a hole.
const [RIM, HOLE] = [0.6, 3];
const AROUND = Array.from({ length: 8 }, (_, i) => [Math.cos((i * Math.PI) / 4), Math.sin((i * Math.PI) / 4)] as const);
/// Where a step cannot be taken, these may be: turned by radians, and shorter.
const TURNS = [0, Math.PI / 4, -Math.PI / 4];

/// A body of that eye height: shoulders, knees and a head of people's proportions.
export function bodyOf(eyeHeight: number): Body {
  return { radius: 0.15 * eyeHeight, step: 0.26 * eyeHeight, height: 1.06 * eyeHeight };
}

function distance(polygon: Polygon, place: Plan): number {
  const { x, z } = nearestOf(polygon, place);
  return Math.hypot(x - place.x, z - place.z);
}

function clearance(polygons: readonly Polygon[], place: Plan): number {
  return Math.min(Infinity, ...polygons.map((each) => distance(each, place)));
}

export class Walker {
  private fallen = 0; // units a second

  constructor(readonly body: Body) {}

  /// As far as one gets on a straight way; along walls, where they are in it.
  move(space: WalkSpace, feet: Feet, by: Plan): Feet {
    const long = Math.hypot(by.x, by.z);
    const steps = Math.max(1, Math.ceil(long / (PART * this.body.radius)));
    let now = feet;
    for (let i = 0; i < steps && long > 0; ++i) {
      const next = this.step(space, now, { x: by.x / steps, z: by.z / steps });
      if (next === null) return now;
      now = next;
    }
    return now;
  }

  /// The feet after so many seconds without a move: they fall, or stand. `gravity`: units a second squared.
  fall(space: WalkSpace, feet: Feet, seconds: number, gravity: number): Feet {
    const ground = this.support(space, feet);
    if (ground === null || ground >= feet.y) {
      this.fallen = 0;
      return ground === null ? feet : { ...feet, y: ground };
    }
    this.fallen += gravity * seconds;
    const y = Math.max(ground, feet.y - this.fallen * seconds);
    if (y === ground) this.fallen = 0;
    return { ...feet, y };
  }

  /// What is drawn is finer now: the feet come to the ground that is nearest to where they were, however it lies there now.
  again(space: WalkSpace, feet: Feet): Feet {
    const [below, above] = [space.ground(feet, feet.y + this.body.step), space.ground(feet, feet.y + 0.7 * this.body.height)];
    if (above === -Infinity) return feet;
    return { ...feet, y: below > -Infinity && feet.y - below <= above - feet.y ? below : above };
  }

  /// Tells whether one can stand there.
  fits(space: WalkSpace, feet: Feet): boolean {
    return clearance(this.around(space, feet, feet.y), feet) >= this.body.radius * (1 - SLACK);
  }

  /// The nearest place where one can stand, pushed out of what is there; null: there is none near.
  stand(space: WalkSpace, feet: Feet): Feet | null {
    const out = this.pushed(this.around(space, feet, feet.y), feet);
    const ground = this.support(space, { ...out, y: feet.y });
    const there = { ...out, y: ground ?? feet.y };
    return ground !== null && Math.abs(ground - feet.y) <= this.body.step && this.fits(space, there) ? there : null;
  }

  private step(space: WalkSpace, feet: Feet, by: Plan): Feet | null {
    for (const turn of TURNS) {
      const [c, s] = [Math.cos(turn), Math.sin(turn)];
      const next = this.tried(space, feet, { x: c * (c * by.x - s * by.z), z: c * (s * by.x + c * by.z) });
      if (next !== null) return next;
    }
    return null;
  }

  /// Null: it cannot be taken.
  private tried(space: WalkSpace, feet: Feet, by: Plan): Feet | null {
    const all = this.around(space, feet, feet.y);
    // what one is in already, as when finer tiles come, is left
    const others = all.filter((each) => distance(each, feet) > 0);
    const to = this.pushed(others, { x: feet.x + by.x, z: feet.z + by.z });
    if (others.some((each) => passes(each, feet, to))) return null;
    const least = Math.min(this.body.radius, clearance(others, feet)) - SLACK * this.body.radius;
    if (clearance(others, to) < least) return null;
    const ground = this.support(space, { ...to, y: feet.y });
    if (ground === null) return null;
    if (ground > feet.y && !this.hasHeadroom(space, feet, { ...to, y: ground })) return null;
    return { ...to, y: ground > feet.y || feet.y - ground <= this.body.step ? ground : feet.y };
  }

  private hasHeadroom(space: WalkSpace, feet: Feet, to: Feet): boolean {
    const above = this.around(space, to, to.y);
    const least = Math.min(this.body.radius, clearance(above, feet)) - SLACK * this.body.radius;
    return clearance(above, to) >= least && !above.some((each) => distance(each, feet) > 0 && passes(each, feet, to));
  }

  /// What stands in the way of feet at that height.
  private around(space: WalkSpace, place: Plan, feet: number): Polygon[] {
    const { radius, step, height } = this.body;
    return space.obstacles(place, 2 * radius, feet + step, feet + height);
  }

  private pushed(polygons: readonly Polygon[], place: Plan): Plan {
    let { x, z } = place;
    for (let i = 0; i < PUSHES; ++i) {
      let deepest = this.body.radius * (1 - SLACK / 2);
      let from: Plan | null = null;
      for (const each of polygons) {
        const near = nearestOf(each, { x, z });
        const away = Math.hypot(near.x - x, near.z - z);
        if (away > 0 && away < deepest) [deepest, from] = [away, near];
      }
      if (from === null) break;
      const part = this.body.radius / deepest;
      [x, z] = [from.x + (x - from.x) * part, from.z + (z - from.z) * part];
    }
    return { x, z };
  }

  /// The height of what the feet stand on, or fall to; null: there is nothing, and no other side of a hole near.
  private support(space: WalkSpace, { x, z, y }: Feet): number | null {
    const { radius, step } = this.body;
    const from = y + step;
    const below = space.ground({ x, z }, from);
    if (below >= y - step) return below;
    const ring = (part: number): number[] => AROUND.map(([c, s]) => space.ground({ x: x + part * radius * c, z: z + part * radius * s }, from));
    const rim = Math.max(...ring(RIM));
    if (rim >= y - step) return Math.min(rim, y);
    if (below > -Infinity) return below;
    const far = ring(HOLE).filter((each) => Math.abs(each - y) <= step);
    return far.length >= AROUND.length / 2 ? y : null;
  }
}
