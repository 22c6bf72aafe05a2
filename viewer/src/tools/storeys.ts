// SPDX-License-Identifier: MIT
// Problem: at which heights do the floors of a house lie, if it is but triangles?
// Idea: a floor is much level area at one height that looks up, with much that looks down above it: its ceiling. Areas by height:
//
//     looks up    |  ####### floor    # table                  ##### floor of the next
//     looks down  |                  # below it     ##### ceiling            ###### ceiling
//                 +-----------------------------------------------------------------------> height
//
// Between two ceilings the largest floor counts: tables and beds are smaller. A ceiling that is much lower than others is none.
// Invariant: the answer follows from triangles and up alone. Cost: O(triangles).
import type { Tile } from '../hierarchy/tile.js';
import { cross, dot, length, subtract, vertexAt, type Vector } from './vectors.js';

/// Heights along up, in the tiles' coordinates.
export interface Storey {
  readonly floor: number;
  readonly ceiling: number;
}

type Mesh = Pick<Tile, 'positions' | 'indices' | 'interiorCount'>;

/// Level area at about one height.
interface Plane {
  readonly height: number;
  readonly area: number;
}

const BINS = 512;
const REACH = 2; // bins on either side of a peak that belong to it
const LEVEL = 0.94; // within 20 degrees
/// Parts of the largest floor and ceiling, from which others count, and from which they say how high rooms are.
const LEAST_PART = 0.12;
const MAIN_PART = 0.5;
/// Part of all area that the largest floor has; of a body that is round hardly any lies at one height.
const LEAST_OF_ALL = 0.03;
/// A ceiling ends a storey only this part of a room's height above its floor.
const LEAST_HEIGHT = 0.6;

/// Sums of areas, and of areas times heights, by height.
class Spread {
  private readonly areas = new Float64Array(BINS);
  private readonly moments = new Float64Array(BINS);

  constructor(private readonly low: number, private readonly high: number) {}

  add(height: number, area: number): void {
    const bin = Math.min(BINS - 1, Math.floor(((height - this.low) / (this.high - this.low)) * BINS));
    this.areas[bin] += area;
    this.moments[bin] += area * (height - this.low);
  }

  /// The largest first, each with what lies near it; then what is left.
  planes(): Plane[] {
    const left = Float64Array.from(this.areas);
    const found: Plane[] = [];
    for (let most = -1; ; most = -1) {
      for (let bin = 0; bin < BINS; ++bin) if (left[bin] > 0 && (most < 0 || left[bin] > left[most])) most = bin;
      if (most < 0) return found;
      let [area, moment] = [0, 0];
      for (let bin = Math.max(0, most - REACH); bin <= Math.min(BINS - 1, most + REACH); ++bin) {
        if (left[bin] === 0) continue;
        area += this.areas[bin];
        moment += this.moments[bin];
        left[bin] = 0;
      }
      found.push({ height: this.low + moment / area, area });
    }
  }
}

function rangeOf({ positions, indices, interiorCount }: Mesh, up: Vector): readonly [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (let i = 0; i < 3 * interiorCount; ++i) {
    const height = dot(vertexAt(positions, indices[i]), up);
    if (height < low) low = height;
    if (height > high) high = height;
  }
  return [low, high];
}

/// Level planes that look up and down, as far as they are large, lowest first.
function levelPlanes(mesh: Mesh, up: Vector): { readonly floors: Plane[]; readonly ceilings: Plane[] } {
  const [low, high] = rangeOf(mesh, up);
  if (!(high > low)) return { floors: [], ceilings: [] };
  const [above, below] = [new Spread(low, high), new Spread(low, high)];
  let all = 0;
  for (let i = 0; i < 3 * mesh.interiorCount; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => vertexAt(mesh.positions, mesh.indices[i + k]));
    const normal = cross(subtract(b, a), subtract(c, a));
    const [area, rise] = [length(normal), dot(normal, up)];
    all += area;
    if (Math.abs(rise) > LEVEL * area) (rise > 0 ? above : below).add((dot(a, up) + dot(b, up) + dot(c, up)) / 3, area);
  }
  const large = (planes: Plane[], least: number): Plane[] => {
    const most = planes.length === 0 ? 0 : planes[0].area;
    return planes.filter(({ area }) => area >= Math.max(LEAST_PART * most, least)).sort((one, other) => one.height - other.height);
  };
  const floors = above.planes();
  if (floors.length === 0 || floors[0].area < LEAST_OF_ALL * all) return { floors: [], ceilings: [] };
  return { floors: large(floors, 0), ceilings: large(below.planes(), LEAST_PART * floors[0].area) };
}

function largest(planes: readonly Plane[]): Plane {
  return planes.reduce((most, each) => (each.area > most.area ? each : most));
}

/// How high the lowest of the main rooms is; Infinity: there are none.
function roomHeight(floors: readonly Plane[], ceilings: readonly Plane[]): number {
  const main = (planes: readonly Plane[]): Plane[] => planes.filter(({ area }) => area >= MAIN_PART * largest(planes).area);
  const heights = main(floors).flatMap(({ height }) => main(ceilings).map((ceiling) => ceiling.height - height).filter((each) => each > 0).slice(0, 1));
  return Math.min(...heights);
}

/// Finds the storeys of a mesh, the lowest first; none: it has no rooms. `up`: of length 1.
export function storeysOf(mesh: Mesh, up: Vector): Storey[] {
  const { floors, ceilings } = levelPlanes(mesh, up);
  if (floors.length === 0 || ceilings.length === 0) return [];
  const least = LEAST_HEIGHT * roomHeight(floors, ceilings);
  const storeys: Storey[] = [];
  for (let from = -Infinity; ; ) {
    const above = floors.filter(({ height }) => height >= from);
    const next = above.map((floor) => ceilings.find(({ height }) => height - floor.height >= least)).find((ceiling) => ceiling !== undefined);
    if (next === undefined) return storeys;
    const floor = largest(above.filter(({ height }) => next.height - height >= least));
    // ceilings up to the next floor are this storey's
    const beyond = floors.find(({ height }) => height >= next.height);
    const own = ceilings.filter(({ height }) => height >= next.height && height < (beyond?.height ?? Infinity));
    storeys.push({ floor: floor.height, ceiling: largest(own.length > 0 ? own : [next]).height });
    from = beyond?.height ?? Infinity;
  }
}
