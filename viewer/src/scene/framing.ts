// SPDX-License-Identifier: MIT
// From where all of a shape fills a picture.
import { Box2, Vector2, Vector3, type Box3 } from 'three';
import { FRAME_MARGIN } from './frame_margin.js';
import type { Projection } from './projection.js';

/// Right, up and forward, of length 1 and at right angles to each other.
export interface Axes {
  readonly right: Vector3;
  readonly up: Vector3;
  readonly forward: Vector3;
}

/// Slopes of the picture's borders against its middle: half its width and height at a distance of 1.
export interface Slopes {
  readonly across: number;
  readonly upwards: number;
}

export interface Framed {
  readonly position: Vector3;
  /// Straight ahead, as far away as the middle of the box.
  readonly target: Vector3;
}

const LEAST_DISTANCE = 0.01; // of the box's diagonal
const FIRST_DIRECTION = new Vector3(0.5, 0.3, 1).normalize();
const WORLD_UP = new Vector3(0, 1, 0);

export function axesOf(forward: Vector3): Axes {
  const right = forward.clone().cross(WORLD_UP);
  if (right.lengthSq() < 1e-12) right.set(1, 0, 0);
  right.normalize();
  return { right, up: right.clone().cross(forward), forward };
}

export function cornersOf({ min, max }: Box3): Vector3[] {
  return [0, 1, 2, 3, 4, 5, 6, 7].map(
    (bits) => new Vector3((bits & 1 ? max : min).x, (bits & 2 ? max : min).y, (bits & 4 ? max : min).z),
  );
}

/// Finds what touches the two borders of the picture that face each other along an axis, `most` on either side: places along the axis, each less or
/// plus its depth times the slope. They say where the camera is on that axis, and how far forward it may go.
class Pair {
  private readonly most: [number, number] = [-Infinity, -Infinity];

  constructor(private readonly slope: number) {}

  add(place: number, depth: number): void {
    this.most[0] = Math.max(this.most[0], place - this.slope * depth);
    this.most[1] = Math.max(this.most[1], -place - this.slope * depth);
  }

  get middle(): number {
    return (this.most[0] - this.most[1]) / 2;
  }

  get depth(): number {
    return -(this.most[0] + this.most[1]) / (2 * this.slope);
  }
}

/// The nearest place that looks along `axes` with all points in the picture; between its borders they leave as much room on the one side as on
/// the other. `points`: of a shape within `box`; none: the box's corners. O(points).
export function frameShape(points: Iterable<Vector3>, box: Box3, { right, up, forward }: Axes, { across, upwards }: Slopes): Framed {
  const centre = box.getCenter(new Vector3());
  const [sides, ends] = [new Pair(across), new Pair(upwards)];
  let count = 0;
  const add = (point: Vector3): void => {
    const [x, y, z] = [point.x - centre.x, point.y - centre.y, point.z - centre.z];
    const depth = x * forward.x + y * forward.y + z * forward.z;
    sides.add(x * right.x + y * right.y + z * right.z, depth);
    ends.add(x * up.x + y * up.y + z * up.z, depth);
    ++count;
  };
  for (const point of points) add(point);
  if (count === 0) cornersOf(box).forEach(add);
  const away = Math.max(-Math.min(sides.depth, ends.depth), LEAST_DISTANCE * box.getSize(new Vector3()).length()) || 1;
  const target = centre.addScaledVector(right, sides.middle).addScaledVector(up, ends.middle);
  return { position: target.clone().addScaledVector(forward, -away), target };
}

/// The same for parallel rays: the target is as far away as in a picture that is so large at it in perspective.
function frameParallel(points: Iterable<Vector3>, box: Box3, { right, up, forward }: Axes, { across, upwards }: Slopes): Framed {
  const centre = box.getCenter(new Vector3());
  const seen = new Box2();
  const add = (point: Vector3): void => {
    const from = point.clone().sub(centre);
    seen.expandByPoint(new Vector2(from.dot(right), from.dot(up)));
  };
  for (const point of points) add(point);
  if (seen.isEmpty()) cornersOf(box).forEach(add);
  const [middle, size] = [seen.getCenter(new Vector2()), seen.getSize(new Vector2())];
  const away = Math.max(size.x / (2 * across), size.y / (2 * upwards), LEAST_DISTANCE * box.getSize(new Vector3()).length()) || 1;
  const target = centre.addScaledVector(right, middle.x).addScaledVector(up, middle.y);
  return { position: target.clone().addScaledVector(forward, -away), target };
}

/// Frames all of a shape, with a margin, in a picture of that aspect whose height is seen at `angle`, in radians. `direction`: to the viewer, of
/// length 1; null: none is better than others. `points`, `box`: as for frameShape().
export function frameWhole(points: Iterable<Vector3>, box: Box3, direction: readonly [number, number, number] | null, angle: number, aspect: number, projection: Projection = 'perspective'): Framed {
  const back = direction === null ? FIRST_DIRECTION : new Vector3(...direction);
  const slope = Math.tan(angle / 2) / FRAME_MARGIN;
  const frame = projection === 'parallel' ? frameParallel : frameShape;
  return frame(points, box, axesOf(back.clone().negate()), { across: slope * aspect, upwards: slope });
}
